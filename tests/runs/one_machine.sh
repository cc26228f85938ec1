#!/usr/bin/env bash
# A whole Slurm on this machine, to try profiles/slurm where there is no cluster: munge, controller and one node
# daemon of Debian's slurm-wlm, started as root with all their files in the folder given. The jobs look for
# /etc/slurm/slurm.conf, which is linked there for as long; a machine that has one of its own is left alone.
#   one_machine.sh start FOLDER
#   one_machine.sh stop FOLDER
set -euo pipefail
action=${1:?start or stop}
folder=$(realpath -m "${2:?folder of its files}")
export SLURM_CONF=$folder/slurm.conf
system=/etc/slurm/slurm.conf

stop() {
    local daemon pids=()
    for daemon in slurmd slurmctld munged; do
        if [ -s "$folder/$daemon.pid" ]; then pids+=("$(cat "$folder/$daemon.pid")"); fi
    done
    for _ in $(seq 60); do # until they have written their last, or the folder cannot be removed
        if ! kill "${pids[@]}" 2>/dev/null; then return; fi
        sleep 0.5
    done
}

# Whether $system is the link of a run of this script that was killed: its controller is gone.
left_behind() {
    local other
    [ -L "$system" ] || return 1
    other=$(dirname "$(readlink "$system")")
    if [ -e "$system" ]; then grep -qx ClusterName=one "$system" || return 1; fi
    ! kill -0 "$(cat "$other/slurmctld.pid" 2>/dev/null)" 2>/dev/null
}

if [ "$action" = stop ]; then
    stop
    if [ "$(readlink "$system")" = "$SLURM_CONF" ]; then rm "$system"; fi
    exit 0
fi
for program in slurmctld slurmd munged; do
    command -v "$program" >/dev/null || { echo "$program is missing: apt-get install slurm-wlm munge" >&2; exit 2; }
done
if [ "$(id -u)" != 0 ]; then echo "the daemons of Slurm start as root only" >&2; exit 2; fi
if left_behind; then rm "$system"; fi
if [ -e "$system" ] || [ -L "$system" ]; then echo "$system exists: this machine has a Slurm already" >&2; exit 2; fi
mkdir -p "$folder"/{state,spool,munge}
chmod 755 "$folder"
chmod 700 "$folder"/munge
dd if=/dev/urandom of="$folder/munge/key" bs=1024 count=1 status=none
chmod 400 "$folder/munge/key"
node=$(hostname -s)
cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc) # nproc would take these for the number of cores
if [ "$cores" -lt 2 ]; then cores=2; fi # the packets of profiles/slurm ask for two
cat >"$SLURM_CONF" <<EOF
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdParameters=config_overrides
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,batch_sched_delay=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
MpiDefault=none
NodeName=$node NodeAddr=127.0.0.1 CPUs=$cores RealMemory=4000 State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
EOF
mkdir -p "$(dirname "$system")"
ln -s "$SLURM_CONF" "$system"
munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
slurmctld
slurmd
for _ in $(seq 60); do
    if sinfo --noheader --format=%T 2>/dev/null | grep -q idle; then exit 0; fi
    sleep 0.5
done
echo "Slurm did not come up; its logs are $folder/slurm*.log" >&2
stop
rm "$system"
exit 1
