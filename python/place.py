# SPDX-License-Identifier: MIT
"""place.py PREFIX: the folder below PREFIX in which this Python looks for modules, relative to it.

Debian's Python looks in /usr/lib/python3/dist-packages, and of other prefixes, as every other
Python does, in lib/python3.X/dist-packages or site-packages."""
import os
import sys
import sysconfig

DEBIAN = "lib/python3/dist-packages"

if sys.argv[1].rstrip("/") == "/usr" and os.path.isdir(f"/usr/{DEBIAN}"):
    print(DEBIAN)
else:
    kind = "dist" if "deb_system" in sysconfig.get_scheme_names() else "site"
    print(f"lib/python{sys.version_info.major}.{sys.version_info.minor}/{kind}-packages")
