"""Which machine this is: what it computes with, and a name that tells it from others without giving it away."""

import hashlib
import os
import platform
from contextlib import suppress
from datetime import datetime, timezone
from functools import cache
from pathlib import Path

CPUINFO = Path("/proc/cpuinfo")
# What tells generations apart, as it is called there.
NUMBERS = {"family": "cpu family", "model": "model"}


def here() -> dict[str, str]:
    """When and where a row is made: the time, UTC, to the second, the machine and its host."""
    return {"when": datetime.now(timezone.utc).isoformat(timespec="seconds"), "machine": machine(), "host": host()}


@cache
def machine() -> str:
    """Processor model and number of logical processors; no host name, no path."""
    try:
        text = CPUINFO.read_text()
    except OSError:
        text = ""
    return f"{_model(text) or platform.processor() or platform.machine()}, {os.cpu_count()} processors"


def _model(text):
    """What Linux says of its first processor: generations may share a name, and libraries compute otherwise on each."""
    said: dict = {}
    for line in text.splitlines():
        name, _, value = line.partition(":")
        said.setdefault(name.strip(), value.strip())
    numbers = [f"{word} {said[name]}" for word, name in NUMBERS.items() if said.get(name)]
    more = f" ({', '.join(numbers)})" if numbers else ""
    return f"{said['model name']}{more}" if said.get("model name") else ""


@cache
def host() -> str:
    """Eight hexadecimal digits that are the same on one machine and differ between machines.

    A digest of the machine's number (Linux) and its name: copies of one image may share the number, containers the
    name. The digest gives away neither.
    """
    number = ""
    with suppress(OSError):
        number = Path("/etc/machine-id").read_text().strip()
    return hashlib.sha256(f"demheat {number} {platform.node()}".encode()).hexdigest()[:8]
