#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Two hosts: network namespaces of this machine with a cable between them. Records equal the records of one process, and
# messages name ranks with their hosts. When a host vanishes the run ends, and the next run continues from its journal.
#
#   two_hosts.sh MPIRUN CDE
set -euo pipefail
skip() { echo "mpi: skipped, $1"; exit 77; }
command -v "$1" >/dev/null || skip "mpirun is not installed (tools/setup test)"
command -v ip >/dev/null || skip "ip is not installed (iproute2)"
[[ $(id -u) == 0 ]] || skip "network namespaces need root"
mpirun=$1 cde=$2 a=cde-a-$$ b=cde-b-$$
folder=$(mktemp -d)
clean() {
  for host in "$a" "$b"; do
    ip netns pids "$host" 2>/dev/null | xargs -r kill -9 2>/dev/null || true
    ip netns del "$host" 2>/dev/null || true
  done
  rm -rf "$folder"
}
trap clean EXIT
cd "$folder"
{ ip netns add "$a" && ip netns add "$b" && ip link add name eth0 netns "$a" type veth peer name eth0 netns "$b" &&
  ip netns exec "$a" unshare --uts true && ip netns exec "$b" unshare --uts hostname cde-b; } 2>why || skip "cannot create network namespaces: $(cat why)"
ip -n "$a" addr add 10.77.0.1/24 dev eth0
ip -n "$b" addr add 10.77.0.2/24 dev eth0
for host in "$a" "$b"; do ip -n "$host" link set dev lo up; ip -n "$host" link set dev eth0 up; done

# Stands in for ssh: runs a command on the host with that address.
cat >remote <<END
#!/bin/bash
shift
exec ip netns exec $b unshare --uts bash -c "hostname cde-b; \$*"
END
chmod +x remote
cat >run <<END
#!/bin/bash
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
exec ip netns exec $a unshare --uts bash -c 'hostname cde-a; exec "\$@"' run "$mpirun" --host 10.77.0.1:1,10.77.0.2:1 -n 2 -mca plm_rsh_agent "$folder/remote" \\
  -mca btl tcp,self -mca btl_tcp_if_include 10.77.0.0/24 -mca oob_tcp_if_include 10.77.0.0/24 "\$@"
END
chmod +x run
fail() { echo "mpi: $1"; exit 1; }
# Brute force, which takes long enough for an interruption.
cast=("$cde" cast "terrain:100,100,1" --no-bvh --grid "${CDE_HOSTS_RAYS:-128x64}" -q)

seconds() { local start=$EPOCHREALTIME; "${@:2}" || fail "status $? of ${*:2}"; awk -v a="$start" -v b="$EPOCHREALTIME" -v of="$1" 'BEGIN { printf "%s: %.2f s\n", of, b - a }'; }
seconds "one process" "${cast[@]}" -o one.csv
seconds "two hosts" ./run "${cast[@]}" -o "$folder/two.csv"
cmp one.csv two.csv || fail "two hosts and one process give different records"

# The message about a rank that disagrees names its host.
echo '0,0,900,0,0,-1' >rays.csv
cat >each <<END
#!/bin/bash
modes=(nearest any)
exec "$cde" cast terrain:16,16,1 --rays "$folder/rays.csv" -o "$folder/x.csv" --mode "\${modes[\$OMPI_COMM_WORLD_RANK]}"
END
chmod +x each
! ./run "$folder/each" 2>said || fail "ranks that disagree were not refused"
grep -q 'rank 1 on cde-b has' said || { cat said; fail "the rank that disagrees is not named"; }
[[ ! -e x.csv ]] || fail "a refused run wrote its output"

# The second host vanishes during the run.
long=("$cde" cast "terrain:100,100,1" --no-bvh --grid 160x128 -q -o "$folder/long.csv" --resume "$folder/journal")
./run "${long[@]}" >/dev/null 2>said & run=$!
for ((tenths = 0; tenths < 300; ++tenths)); do
  [[ $(grep -a -c '^{"part":0,"chunk":' journal 2>/dev/null) -lt 3 ]] || break
  sleep 0.1
done
ip netns pids "$b" | xargs -r kill -9
status=0
vanished=$EPOCHREALTIME
wait "$run" || status=$?
ended=$EPOCHREALTIME
[[ $status != 0 ]] || fail "a run whose second host vanished ended with status 0"
[[ ! -e long.csv ]] || fail "the interrupted run left an output"
grep -q -e 10.77.0.2 -e cde-b said || { cat said; fail "the vanished host is not named"; }
kept=$(grep -a -c '^{"part":0,"chunk":' journal)
./run "${long[@]}" || fail "the run did not continue"
"$cde" cast "terrain:100,100,1" --grid 160x128 -q -o whole.csv
cmp whole.csv long.csv || fail "the continued run and an uninterrupted run give different records"
echo "a host vanished: status $status after $(awk -v a="$vanished" -v b="$ended" 'BEGIN { printf "%.1f", b - a }') s, continued from $kept chunks of $(grep -a -c '^{"part":0,"chunk":' journal)"
