"""Stores: results by key, in memory and on disk, bounded in bytes.

A key stands for all that a result depends on, so nothing need be compared. Stores on disk hold
JSON and raw arrays, never pickles: reading one runs no code of its own. What is damaged,
incomplete or of another version is as good as missing.

digests     Fingerprints of values and files by content.
disk        Results on disk, shared by processes.
entries     What is kept of a step: value, messages, files, seconds.
flights     One at a time for each key, among threads.
footprints  How many bytes a value takes, shared arrays counted once.
memory      Results in memory, the longest unused forgotten first.
origins     The code that a result comes from, as a fingerprint.
packing     Values as JSON and blocks of bytes, and back.
results     Results that nobody can change for others.
"""
