"""What of an address tells clients apart."""

from __future__ import annotations

from functools import lru_cache
from ipaddress import IPv6Address, ip_address

NETWORK = 64
"""Of an address of IPv6 so many bits count: the rest is for its holder to choose."""


@lru_cache(maxsize=4096)
def network(address: str) -> str:
    """What of an address tells clients apart: all of one of IPv4, the first bits of one of IPv6."""
    try:
        parsed = ip_address(address)
    except ValueError:
        return "elsewhere"  # a socket without addresses, or a name that a proxy has given
    if isinstance(parsed, IPv6Address) and parsed.ipv4_mapped is None:
        return f"{IPv6Address(int(parsed) >> (128 - NETWORK) << (128 - NETWORK))}/{NETWORK}"
    return str(parsed.ipv4_mapped if isinstance(parsed, IPv6Address) else parsed)
