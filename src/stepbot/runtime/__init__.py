"""Everything about running and nothing about robots: processes, the cache, the output folder, memory and cores.

May be imported by any room above.

Processes::

    with Worker("package.module:function", memory_limit=..., start=...) as worker:   # worker
        answer = worker.submit(*arguments).result(timeout)                           # WorkerDied, RemoteError
    with ForkServer(modules) as server:                                              # fork_server
        Worker(function, start=server.fork)                                          # as above, imports shared
    run(function, numbers, seconds=..., attempt=...)                                 # parallel, attempts

Cache of results by content::

    key = Digest("purpose").add(environment(), *inputs).key                          # cache.sources
    known = TypedCache(Cache(folder), Kind).get(key)                                 # cache.codec, cache.store
    TypedCache(Cache(folder), Kind).put(key, value)

Decision 0021 compares both with libraries.
"""
