#!/bin/sh
# Makes sure that the named Debian packages are there: installs the missing ones as root, otherwise
# stops with the list. Usage: tools/debian.sh PACKAGE...
set -eu
if ! command -v dpkg-query >/dev/null; then
  [ $# -eq 0 ] || echo "Not a Debian system: make sure that you have what Debian calls $*" >&2
  exit 0
fi
missing=
for package in "$@"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0
if [ "$(id -u)" -ne 0 ]; then
  echo "These Debian packages are missing; please install them and run make again:" >&2
  echo "  sudo apt-get install$missing" >&2
  exit 1
fi
echo "Installing$missing"
apt-get update -qq
# shellcheck disable=SC2086
DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends $missing >/dev/null
