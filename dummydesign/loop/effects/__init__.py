"""Effects that the base model lacks, a file each in ``rig``, ``material``, ``history`` and ``sensor``."""
