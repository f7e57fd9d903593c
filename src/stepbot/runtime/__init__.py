"""Everything about running and nothing about robots: processes, the cache, the output folder, memory and cores.

May be imported by any room above.
"""
