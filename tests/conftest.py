import os
import tempfile

# Tests make their own packings and never touch the user's; set before anything reads it.
os.environ.setdefault("DEMHEAT_CACHE", tempfile.mkdtemp(prefix="demheat-test-cache-"))
