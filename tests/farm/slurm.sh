#!/bin/bash
# slurm.sh NODES COMMAND...: a Slurm of its own on this machine (munge, slurmctld, NODES slurmd on loopback) while COMMAND runs, which
# finds it through SLURM_CONF. $CLUSTER is its folder: node1.pid and so on hold the ids of the slurmd. Ends all processes it started, by
# their ids. Exit status: COMMAND's; 77 where daemons cannot be started here, with the reason.
set -u
nodes=$1
shift
skip() { echo "skipped: $*"; exit 77; }
for program in munged slurmctld slurmd sbatch; do command -v $program >/dev/null || skip "there is no $program"; done
[ "$(id -u)" = 0 ] || skip "Slurm's daemons start other users' jobs: only root can"

export CLUSTER
CLUSTER=$(mktemp -d /tmp/r2m-slurm.XXXXXX) || skip "no folder"
chmod 755 "$CLUSTER"
started=()
end_all() {
    # Its jobs and their guards first, which slurmd leaves running: they have its folder in their environment.
    for place in /proc/[0-9]*; do
        grep -qszx "CLUSTER=$CLUSTER" "$place/environ" && kill -9 "${place#/proc/}" 2>/dev/null
    done
    for id in "${started[@]}"; do kill "$id" 2>/dev/null; done
    sleep 0.5
    for id in "${started[@]}"; do kill -9 "$id" 2>/dev/null; done
    rm -rf "$CLUSTER"
}
trap end_all EXIT

# Munge: the socket's folders may not be writable by others.
dd if=/dev/urandom of="$CLUSTER/key" bs=1024 count=1 2>/dev/null
chown munge: "$CLUSTER/key" 2>/dev/null && chmod 400 "$CLUSTER/key"
mkdir "$CLUSTER/munge" && chown munge: "$CLUSTER/munge"
setpriv --reuid=munge --regid=munge --clear-groups munged --foreground --force --key-file="$CLUSTER/key" \
    --socket="$CLUSTER/munge/socket" --pid-file="$CLUSTER/munge/pid" --seed-file="$CLUSTER/munge/seed" \
    --log-file="$CLUSTER/munge/log" >"$CLUSTER/munge.out" 2>&1 &
started+=($!)

# Ports that nobody listens to.
port=$((20000 + RANDOM % 20000))
while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 100)); done
host=$(hostname -s)
{
    cat <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$CLUSTER/munge/socket,cred_expire=5
CredType=cred/munge
SlurmctldPort=$port
SlurmctldPidFile=$CLUSTER/slurmctld.pid
SlurmctldLogFile=$CLUSTER/slurmctld.log
StateSaveLocation=$CLUSTER/state
SlurmdSpoolDir=$CLUSTER/spool.%n
SlurmdPidFile=$CLUSTER/%n.slurmd
SlurmdLogFile=$CLUSTER/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
ReturnToService=2
SlurmdTimeout=10
SlurmctldTimeout=10
InactiveLimit=0
KillWait=2
MinJobAge=300
JobRequeue=1
END
    for ((i = 1; i <= nodes; i++)); do
        echo "NodeName=node$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + i)) CPUs=1 State=UNKNOWN"
    done
    echo "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
} >"$CLUSTER/slurm.conf"
export SLURM_CONF=$CLUSTER/slurm.conf
mkdir "$CLUSTER/state"

slurmctld -D -f "$SLURM_CONF" >"$CLUSTER/slurmctld.out" 2>&1 &
started+=($!)
for ((i = 1; i <= nodes; i++)); do
    mkdir "$CLUSTER/spool.node$i"
    slurmd -D -N "node$i" -f "$SLURM_CONF" >"$CLUSTER/node$i.out" 2>&1 &
    started+=($!)
    echo $! >"$CLUSTER/node$i.pid"
done
for ((i = 0; i < 150; i++)); do
    [ "$(sinfo --noheader --format=%t --Node 2>/dev/null | grep -c idle)" = "$nodes" ] && break
    sleep 0.2
done
if [ "$i" = 150 ]; then
    tail -n 5 "$CLUSTER"/*.log "$CLUSTER"/*.out 2>/dev/null
    skip "Slurm's daemons do not start"
fi
"$@"
