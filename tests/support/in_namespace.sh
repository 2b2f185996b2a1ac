#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# in_namespace.sh COMMAND...: runs COMMAND in a network namespace of its own, where loopback carries multicast
# and nobody else listens. Works for root and, where the kernel allows it, for anybody. Exit code: COMMAND's,
# or 97 when no namespace can be had.
set -u
if [ $# -eq 0 ]; then
  echo "usage: $0 COMMAND..." >&2
  exit 2
fi
if ! command -v ip >/dev/null; then
  echo "$0: the command ip is missing; install the package iproute2" >&2
  exit 97
fi
setup='ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 97; exec "$@"'
if unshare -n true 2>/dev/null; then
  exec unshare -n bash -c "$setup" in_namespace "$@"
elif unshare -rn true 2>/dev/null; then
  exec unshare -rn bash -c "$setup" in_namespace "$@"
fi
echo "$0: cannot make a network namespace; be root with CAP_SYS_ADMIN, or run:" >&2
echo "  sudo sysctl -w kernel.unprivileged_userns_clone=1 user.max_user_namespaces=1000" >&2
exit 97
