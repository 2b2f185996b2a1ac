#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# three_hosts_test.sh BIN_DIR: three hosts (network namespaces on a bridge) run what docs/machines.md says: two robots, one
# fusion node. The fusion node is killed once and one robot too; in the end the node holds everything and the console,
# on its host, says so. Needs root; inside a network namespace of its own (in_namespace.sh).
set -euo pipefail
bin=$(realpath "$1")
top=$(mktemp -d)
hosts=(reef-a reef-b shore)
suffix=$$
pids=()

cleanup() {
  for pid in "${pids[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
  for host in "${hosts[@]}"; do ip netns del "$host-$suffix" 2>/dev/null || true; done
  rm -rf "$top"
}
trap cleanup EXIT

fail() {
  echo "three_hosts_test: $*" >&2
  tail -n 20 "$top"/*.log >&2
  exit 1
}

ip link add br0 type bridge mcast_snooping 0
ip link set br0 up
number=0
for host in "${hosts[@]}"; do
  number=$((number + 1))
  ip netns add "$host-$suffix"
  ip link add "v$number" type veth peer name eth0 netns "$host-$suffix"
  ip link set "v$number" master br0 up
  ip -n "$host-$suffix" link set lo up
  ip -n "$host-$suffix" addr add "10.7.0.$number/24" dev eth0
  ip -n "$host-$suffix" link set eth0 up
  ip -n "$host-$suffix" route add 224.0.0.0/4 dev eth0
done

export SHOAL_LCM_URL='udpm://239.255.76.67:7667?ttl=1'

# on HOST NAME PROGRAM...: starts it there; its pid goes to $started.
on() {
  local host=$1 name=$2
  shift 2
  ip netns exec "$host-$suffix" "$@" >>"$top/$name.log" 2>&1 &
  started=$!
  pids+=("$started")
}
robot() {
  on "$1" "$2" "$bin/robot_agent" --robot "$2" --robots 2 --mission reef7 --source reef:tuning --observations 12 --rate 2 \
    --checkpoint "$top/$2" --out "$top/out" --linger
}
fusion() {
  on shore OPERATOR "$bin/fusion_node" --node OPERATOR --mission reef7 --rate 2 --state "$top/fusion" --out "$top/out"
}
ask() { ip netns exec "shore-$suffix" "$bin/operator_console" "$@" --node "$top/fusion" --json; }

# wait_for SECONDS TEXT FILE
wait_for() {
  for _ in $(seq "$1"); do
    grep -q "$2" "$3" 2>/dev/null && return
    sleep 1
  done
  fail "\"$2\" did not come into $3"
}

fusion
first_fusion=$started
robot reef-a R00
robot reef-b R01
first_r01=$started
wait_for 120 "flies" "$top/R01.log"
for _ in $(seq 120); do
  python3 -c 'import glob, sqlite3, sys
sys.exit(not any(sqlite3.connect(f).execute("SELECT count(*) FROM heard WHERE channel NOT LIKE ?", ("%HEARTBEAT",)).fetchone()[0]
                 for f in glob.glob(sys.argv[1])))' "$top/fusion/mission-*.sqlite" && [[ -e $top/R01/R01.checkpoint ]] && break
  sleep 1
done
kill -9 "$first_fusion" "$first_r01"
sleep 1
fusion
robot reef-b R01
wait_for 60 "comes back with" "$top/OPERATOR.log"
wait_for 60 "goes on from a checkpoint" "$top/R01.log"
wait_for 180 "landed after 12 observations" "$top/R00.log"
wait_for 180 "landed after 12 observations" "$top/R01.log"
for _ in $(seq 120); do
  whole=$(ask status | python3 -c '
import json, sys
nodes = {n["name"]: n for n in json.load(sys.stdin)["nodes"]}
print(all(nodes.get(r, {}).get("heard_whole") for r in ("R00", "R01")))') || whole=
  [[ $whole == True ]] && break
  sleep 1
done
[[ ${whole:-} == True ]] || fail "OPERATOR does not hold all of both robots"
(($(ask labels | wc -c) > 100)) || fail "no labels"
echo "three hosts agree"
