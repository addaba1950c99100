"""Commands of the program as steps whose figures stay: for scripts that may be run again."""
import json
import pathlib
import subprocess
import sys

PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "build" / "promenade"


def run(words, json_file):
    """One command; its figures. A step that has left its JSON already is not run again. Ends the script where it fails, with its words;
    what `verify` missed is a figure, no failure."""
    if not json_file.exists():
        print("$ promenade", *words, file=sys.stderr, flush=True)
        done = subprocess.run([str(PROGRAM), *map(str, words), "--json", str(json_file)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        figures = json.loads(json_file.read_text()) if json_file.exists() else {}
        if done.returncode != 0 and not figures.get("missed"):
            json_file.unlink(missing_ok=True)
            sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {done.stderr.strip()[-2000:]}")
    return json.loads(json_file.read_text())
