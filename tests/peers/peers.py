"""What the scripts of this folder share: a peer's programs, compiled with irt_virtual_module(), and
what `irt check` says of each. Nothing of them is kept but in build/peers/NAME, with the logs."""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[2]
IRT = HERE / "build" / "development"
CHECK = IRT / "lib" / "irt" / "irt-check"
TABLE = ["| program | known | verdict | | executions | seconds |", "|---|---|---|---|---|---|"]


def stop(message):
    sys.exit(f"tests/peers/{pathlib.Path(sys.argv[0]).name}: {message}")


def arguments(description, only, seconds, **folder):
    """`folder` is how argparse takes the peer's folders."""
    parser = argparse.ArgumentParser(description=description,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, **folder)
    parser.add_argument("--only", default="", help=only)
    parser.add_argument("--seconds", type=float, default=seconds, help="for each program")
    parser.add_argument("--out", type=pathlib.Path, help="the table")
    options = parser.parse_args()
    if not CHECK.exists():
        stop("irt-check is not built; ./irt check builds it")
    return options


class Project:
    """The programs of the peer `name`, whose headers are replaced by `headers` (name: text)."""

    def __init__(self, name, headers):
        self.folder = HERE / "build" / "peers" / name
        self.modules = {}
        shutil.rmtree(self.folder, ignore_errors=True)
        (self.folder / "shim").mkdir(parents=True)
        for header, text in headers.items():
            (self.folder / "shim" / header).write_text(text)

    def add(self, module, sources, options):
        """`options` in CMake's words."""
        quoted = " ".join(f'"{s}"' for s in sources)
        self.modules[module] = (f"irt_virtual_module({module} SOURCES {quoted} OPTIONS {options})\n"
                                f"add_dependencies(everything {module})\n")

    def build(self):
        """What does not compile is missing afterwards."""
        (self.folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(peers LANGUAGES C CXX)\n"
            "find_package(irt REQUIRED)\nset(CMAKE_CXX_STANDARD 20)\nset(CMAKE_C_STANDARD 17)\n"
            "include_directories(BEFORE ${CMAKE_CURRENT_SOURCE_DIR}/shim)\n"
            "add_custom_target(everything ALL)\n" + "".join(self.modules.values()))
        build = self.folder / "build"
        with open(self.folder / "build.log", "w") as log:
            subprocess.run(["cmake", "-G", "Ninja", "-S", self.folder, "-B", build,
                            f"-DCMAKE_PREFIX_PATH={IRT}"], stdout=log, stderr=log, check=True)
            subprocess.run(["ninja", "-k", "0", "-C", build, "everything"], stdout=log, stderr=log)

    def check(self, module, name, seconds, *options):
        """The verdict and, if there was one, whether something was found, the executions of all
        searches, those that were complete if all were looked at, and what was not."""
        file = self.folder / "build" / f"{module}.so"
        if not file.exists():
            return {"verdict": "does not compile"}
        result = self.folder / "result.json"
        result.unlink(missing_ok=True)
        try:
            ran = subprocess.run([CHECK, "--program", name, "--module", file, "--json", result,
                                  "--no-leaks", "--threads", "15", "--seconds", str(seconds),
                                  "--quiet", *options],
                                 capture_output=True, text=True, timeout=seconds + 120)
        except subprocess.TimeoutExpired:
            return {"verdict": "hangs"}
        with open(self.folder / f"{module}.txt", "a") as report:
            report.write(ran.stdout + ran.stderr)
        if not result.exists():
            return {"verdict": (ran.stderr.strip().splitlines() or ["?"])[-1]}
        searches = json.loads(result.read_text())["searches"]
        whole = [s for s in searches if s["search"] == "exhaustive" and s["finished"]]
        found = [s["finding"]["kind"] for s in searches if "finding" in s]
        return {"verdict": found[0] if found else "whole" if whole else "not whole",
                "found": bool(found), "executions": sum(s["executions"] for s in searches),
                "complete": whole[-1]["complete"] if whole else None,
                "incomplete": searches[-1]["incomplete"],
                "seconds": sum(s["seconds"] for s in searches)}


def judged(result, wrong, accepted=None):
    """`accepted`: what one that is wrong may be accused of; None: anything."""
    if "found" not in result:
        return "not run"
    if result["found"]:
        return "agrees" if wrong and result["verdict"] in (accepted or [result["verdict"]]) else "DIFFERS"
    if result["verdict"] != "whole":
        return "not whole"
    return "DIFFERS" if wrong else "agrees"


def add_row(table, name, known, result, state):
    table.append(f"| {name} | {known} | {result['verdict']} | {state} | "
                 f"{result.get('executions', '')} | {result.get('seconds', 0):.1f} |")
    print(table[-1], flush=True)


def finish(table, out, differs):
    if out:
        out.write_text("\n".join(table) + "\n")
    sys.exit(differs)
