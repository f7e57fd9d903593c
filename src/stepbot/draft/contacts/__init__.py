"""Contacts of parts, and the motion that they leave."""
