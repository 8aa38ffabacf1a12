"""usage: check_slurm.py CLOTHBENCH SOURCE: a study as a Slurm array, on a Slurm of one node that this script starts.

Needs root, and Debian's slurm-wlm and munge; otherwise it prints what is missing and counts as skipped. All files are in a
temporary folder, and all processes are stopped by process number.
"""
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time

CLOTHBENCH, SOURCE = sys.argv[1:3]
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo")
missing = [p for p in NEEDED if not shutil.which(p, path=os.environ["PATH"] + ":/usr/sbin")]
if missing or os.geteuid() != 0:
    print("SKIPPED: " + (f"no {', '.join(missing)} (Debian: slurm-wlm munge)" if missing else "not root"))
    sys.exit(77)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Cluster:
    """Runs munged, slurmctld and slurmd in a folder."""

    def __init__(self, home):
        self.home, self.started = home, []
        os.environ["SLURM_CONF"] = os.path.join(home, "slurm.conf")
        os.environ["PATH"] += ":/usr/sbin"
        for folder in ("state", "spool", "munge"):
            os.mkdir(os.path.join(home, folder))
        key, munge = os.path.join(home, "munge", "key"), os.path.join(home, "munge", "socket")
        with open(key, "wb") as out:
            out.write(os.urandom(1024))
        os.chmod(key, 0o400)
        host = socket.gethostname().split(".")[0]
        with open(os.environ["SLURM_CONF"], "w", encoding="utf-8") as out:
            out.write(
                f"ClusterName=test\nSlurmctldHost={host}(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n"
                f"SlurmctldPort={free_port()}\nSlurmdPort={free_port()}\nAuthType=auth/munge\nCryptoType=crypto/munge\n"
                f"AuthInfo=socket={munge}\nStateSaveLocation={home}/state\nSlurmdSpoolDir={home}/spool\n"
                f"SlurmctldPidFile={home}/ctld.pid\nSlurmdPidFile={home}/slurmd.pid\nSlurmctldLogFile={home}/ctld.log\n"
                f"SlurmdLogFile={home}/slurmd.log\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\n"
                "SchedulerType=sched/backfill\nSelectType=select/cons_tres\nJobAcctGatherType=jobacct_gather/none\n"
                f"AccountingStorageType=accounting_storage/none\nReturnToService=2\nNodeName={host} NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN\n"
                f"PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP\n"
            )
        self.start("munged", "--foreground", "--force", "--key-file", key, "--socket", munge, "--pid-file", home + "/munged.pid",
                   "--log-file", home + "/munged.log", "--seed-file", home + "/munge/seed")
        time.sleep(1)
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")

    def start(self, *words):
        with open(os.path.join(self.home, words[0] + ".out"), "wb") as out:
            self.started.append(subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT))

    def stop(self):
        for process in reversed(self.started):
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()

    def logs(self):
        text = ""
        for name in ("munged.out", "slurmctld.out", "slurmd.out"):
            with open(os.path.join(self.home, name), encoding="utf-8", errors="replace") as out:
                text += f"--- {name}\n" + "".join(out.readlines()[-8:])
        return text

    def wait(self, what, condition, seconds=120):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"{what} did not come\n" + self.logs()
            time.sleep(0.5)


def said(*words):
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()


with tempfile.TemporaryDirectory(prefix="clothbench-slurm-") as home:
    cluster = Cluster(home)
    try:
        cluster.wait("an idle node", lambda: said("sinfo", "-h", "-o", "%T") == "idle", 60)
        out = os.path.join(home, "a run")
        options = ["--quick", "--trials", "1", "--solver", "ballistic", "--set", "cloth.size_m=[1.0, 0.5]"]
        script = os.path.join(SOURCE, "scripts", "slurm_study.sh")
        submitted = subprocess.run([script, "table3", out, *options], env=dict(os.environ, CLOTHBENCH=CLOTHBENCH),
                                   capture_output=True, text=True, check=False)
        assert submitted.returncode == 0, submitted.stderr + cluster.logs()
        cluster.wait("the jobs' end", lambda: said("squeue", "-h") == "", 180)
        with open(os.path.join(out, "study.json"), encoding="utf-8") as text:
            planned = json.load(text)["runs"]
        logs = "".join(open(os.path.join(out, "log", f), encoding="utf-8").read() for f in os.listdir(os.path.join(out, "log")))
        assert {f[:-3] for f in os.listdir(out) if f.endswith(".h5")} == set(planned), logs
        assert len([f for f in os.listdir(os.path.join(out, "log")) if f.startswith("run-")]) == len(planned)
        with open(os.path.join(out, "report", "report.md"), encoding="utf-8") as text:
            assert "planned, not run" not in text.read()
        print(f"{len(planned)} runs in a Slurm array, one report")
    finally:
        cluster.stop()
