"""Judges falsified motions (lies) and correct ones in parallel: `matrix.py run LIARS RESULT`, then `matrix.py table RESULT`.

RESULT has one line of JSON per judged motion and one per finished seed, so that a call continues where the last one was
stopped. `liars` finds scenes through CLOTHBENCH_SCENARIOS and CLOTHBENCH_ASSETS."""
import argparse
import collections
import concurrent.futures
import json
import lzma
import math
import pathlib
import subprocess
import time

EXACT = "exact solution"
CHECKS = {"kinematic": ["attachments"], "dynamic": ["momentum", "hinges", "limits", "smoothness"], "continuous": ["passages", "self"], "present": [], EXACT: []}
COSTS = ["paper/hand-push", "paper/capsule-sweep", "contact/box"]
RIGHT, NOISY = "the right motion", "noise of 0.1 mm per m"


def short(x):
    """Three significant digits; a number that is not finite becomes text."""
    return x if not isinstance(x, float) else float(f"{x:.3g}") if math.isfinite(x) else str(x)


def row_of(trial):
    statistic, over, frame = trial["worst"]
    row = {k: trial[k] for k in ("kind", "seed", "solver", "lie", "right", "determined", "failed")}
    by = {a[0] for a in trial["alarms"].values()} | ({EXACT} if (trial["solution"] or 0) > 1 else set())
    row |= {"by": sorted(by), "worst": statistic, "over": short(over), "frame": frame, "alarms": sorted(trial["alarms"]), "off_m": short(trial["off_m"])}
    return row | ({} if trial["solution"] is None else {"solution": short(trial["solution"])})


def judge(liars, job, limit_s):
    """Rows of one seed, the last of which says how it ended."""
    kind, seed = job
    what = {"costs": ["--cost", str(seed)], "lies": ["--seed", str(seed), "--motions", "1"], "right": ["--seed", str(seed), "--motions", "1", "--lie", "none"]}[kind]
    start, rows, done = time.monotonic(), [], {"done": kind, "seed": seed}
    try:
        call = subprocess.run([liars, *what], capture_output=True, text=True, timeout=limit_s)
        trials = [json.loads(line) for line in call.stdout.splitlines()]
        rows = trials if kind == "costs" else [row_of(t) for t in trials]
        if call.returncode:
            done["failed"] = (call.stderr.strip().splitlines() or [f"exit {call.returncode}"])[-1]
    except subprocess.TimeoutExpired:
        done["failed"] = "too slow"
    return rows + [done | {"wall_s": round(time.monotonic() - start, 1)}]


def rows_of(result):
    if not result.exists():
        return []
    text = lzma.decompress(result.read_bytes()).decode() if result.suffix == ".xz" else result.read_text()
    return [json.loads(line) for line in text.splitlines()]


def run(a):
    finished = {(r["done"], r["seed"]) for r in rows_of(a.result) if "done" in r}
    jobs = [("lies", a.lies[0] + i) for i in range(a.lies[1])] + [("right", a.right[0] + i) for i in range(a.right[1])]
    end = time.monotonic() + a.stop_after

    def work(job):
        left = end - time.monotonic()
        rows = judge(a.liars, job, min(left, a.limit)) if left > 1 else []
        return rows if time.monotonic() < end else []  # time ran out

    with a.result.open("a") as out:
        def keep(rows):
            out.writelines(json.dumps(r) + "\n" for r in rows)
            out.flush()

        for name in COSTS if a.costs else []:  # without other processes on the machine
            if ("costs", name) not in finished:
                keep(judge(a.liars, ("costs", name), a.limit))
        with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
            for future in concurrent.futures.as_completed([pool.submit(work, j) for j in jobs if j not in finished]):
                keep(future.result())
    print(table(a.result))


def wilson(some, of):
    """Count, fraction and 95 % interval (Wilson)."""
    if of == 0:
        return "none"
    z, p = 1.96, some / of
    middle, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    low, high = ((middle - half) / (1 + z * z / of), (middle + half) / (1 + z * z / of))
    return f"{some} of {of}: {100 * p:.1f} % ({100 * max(low, 0):.1f} to {100 * high:.1f} %)"


def table(result):
    rows = rows_of(result)
    trials, costs, done = ([r for r in rows if key in r] for key in ("lie", "cost", "done"))
    lies = [t for t in trials if t["determined"] and not t["right"]]
    tried = [t for t in trials if t["lie"] == RIGHT]
    right = [t for t in tried if EXACT not in t["by"]]  # the other motions are not correct
    noisy = [t for t in trials if t["lie"] == NOISY]
    scenes = [c["cost"] for c in costs]
    out = ["## Checks", "", "| check | " + " | ".join(["lies caught", "by no other check", "right motions failed", *scenes]) + " |", "|---" * (4 + len(scenes)) + "|"]
    for check, parts in CHECKS.items():
        ms = [f"{sum(c['parts_ms'][p] for p in parts):.2f}" if parts else "" for c in costs]
        failed = wilson(sum(check in t["by"] for t in right), len(right)) if check != EXACT else ""
        out.append("| " + " | ".join([check, wilson(sum(check in t["by"] for t in lies), len(lies)), str(sum(t["by"] == [check] for t in lies)), failed, *ms]) + " |")
    by_motion = [t for t in lies if set(t["by"]) - {EXACT}]
    ms = [f"{c['check_ms']:.2f}" for c in costs]
    out.append("| " + " | ".join(["the four checks", wilson(len(by_motion), len(lies)), "", wilson(sum(t["failed"] for t in right), len(right)), *ms]) + " |")
    out.append("| " + " | ".join(["all", wilson(sum(t["failed"] for t in lies), len(lies)), "", "", *[f"other metrics {c['other_metrics_ms']:.2f}" for c in costs]]) + " |")
    solvers = collections.Counter(t["solver"] for t in right)
    out += ["", "Right motions: " + ", ".join(f"{n} by `{s}`" for s, n in sorted(solvers.items())) + f", of {len({t['kind'] for t in right})} kinds of scenes; "
            f"{len(tried) - len(right)} more miss their exact solution. With noise of 0.1 mm per m {wilson(sum(t['failed'] for t in noisy), len(noisy))} fail."]
    told = [t for t in trials if not t["determined"] and not t["right"]]
    out += [f"Lies that positions do not determine: {wilson(sum(t['failed'] for t in told), len(told))} caught."]
    listed = {"Missed": [t for t in lies if not t["failed"]], "Right and failed": [t for t in right + noisy if t["failed"]], "Off the exact solution": [t for t in tried if EXACT in t["by"]]}
    for title, of in listed.items():
        out += ["", f"## {title}", ""] + [f"- {t['kind']} {t['seed']}, {t['solver']}: {t['lie']}; {t['worst']} {t['over']} in frame {t['frame']}, off by {t['off_m']} m, exact solution {t.get('solution')}" for t in of]
    return "\n".join(out + ["", "## Not judged", ""] + [f"- {d['done']} {d['seed']}: {d['failed']}" for d in done if "failed" in d])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("run")
    command.add_argument("liars", type=lambda path: pathlib.Path(path).resolve(), help="the program")
    command.add_argument("result", type=pathlib.Path)
    command.add_argument("--lies", type=int, nargs=2, default=[970000, 0], metavar=("SEED", "COUNT"), help="right motions for every lie")
    command.add_argument("--right", type=int, nargs=2, default=[980000, 0], metavar=("SEED", "COUNT"), help="right motions without lies")
    command.add_argument("--costs", action="store_true", help="time the check first")
    command.add_argument("--jobs", type=int, default=1, help="at once")
    command.add_argument("--limit", type=float, default=300, help="seconds per seed")
    command.add_argument("--stop-after", type=float, default=math.inf, help="seconds after which the remaining seeds are left for the next call")
    command.set_defaults(work=run)
    command = commands.add_parser("table")
    command.add_argument("result", type=pathlib.Path)
    command.set_defaults(work=lambda a: print(table(a.result)))
    a = parser.parse_args()
    a.work(a)


if __name__ == "__main__":
    main()
