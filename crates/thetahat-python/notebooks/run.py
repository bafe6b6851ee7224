"""Executes the notebooks of this folder, each in its own kernel: `python run.py [--only NAME] [FOLDER]`, where FOLDER takes the executed copies.

Needs nbclient and ipykernel. A notebook that is stored with outputs is refused: they would not be those of this version.
"""

import argparse
import os
import pathlib
import sys
import time

import nbclient
import nbformat

HERE = pathlib.Path(__file__).resolve().parent


def require_no_outputs(path: pathlib.Path, notebook: nbformat.NotebookNode) -> None:
    """Refuse what is stored with outputs."""
    if any(cell.get("outputs") or cell.get("execution_count") for cell in notebook.cells):
        sys.exit(f"{path.name}: is stored with outputs; clear them")


def said(notebook: nbformat.NotebookNode) -> list[str]:
    """The lines with which a notebook says what it leaves out."""
    outputs = (output for cell in notebook.cells for output in cell.get("outputs", ()))
    return [line for output in outputs for line in output.get("text", "").splitlines() if line.startswith("***")]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", metavar="NAME")
    parser.add_argument("folder", type=pathlib.Path, nargs="?")
    asked = parser.parse_args()
    for path in sorted(HERE.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        require_no_outputs(path, notebook)
        if asked.only not in (None, path.stem):
            continue
        start = time.perf_counter()
        nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": HERE}}).execute()
        print(f"{path.name}: {time.perf_counter() - start:.1f} s", *said(notebook), sep="\n")
        if asked.folder:
            nbformat.write(notebook, asked.folder / path.name)


if __name__ == "__main__":
    os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")
    main()
