#!/usr/bin/env python3
"""Check the prose of liehom against the rules of CONTRIBUTING.md. Standard library only.

    python prose_check.py README.md docs liehom                     list every hit
    python prose_check.py README.md docs liehom --summary           count the hits of each rule
    python prose_check.py ... --baseline FILE --update              record today's counts for each file and rule
    python prose_check.py ... --baseline FILE                       exit with 1 if any count has risen
    python prose_check.py ... --dump                                print the extracted prose, tab-separated

Code fences, doctests and indented formulas are dropped; inline code becomes CODE, mathematics MATH.  Kinds of prose:
heading, md, table, module, doc1 (first paragraph of a class or function docstring), doc, comment, message (arguments
of raise), help (typer help=), test (names of tests).  A line that contains "prose: ok" is not checked.
"""

from __future__ import annotations

import argparse
import ast
import collections
import io
import json
import pathlib
import re
import sys
import tokenize

SKIP = {".git", ".venv", "build", "dist", "_build", ".hypothesis", "__pycache__"}


def clean(text: str) -> str:
    """Return text with code, mathematics and links replaced by placeholders."""
    text = re.sub(r"\{[a-z]+\}`[^`]*`", "MATH", text)
    text = re.sub(r"``[^`]+``|`[^`]+`", "CODE", text)
    text = re.sub(r"\$\$.*?\$\$|\$[^$]+\$", "MATH", text, flags=re.S)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", lambda m: m[1] or "LINK", text)
    return re.sub(r"\s+", " ", text.replace("**", "").replace("*", "")).strip()


def markdown(path: pathlib.Path, source: str):
    """Yield (kind, place, text) for the paragraphs, headings and table cells of Markdown."""
    fence, block, start, math = None, [], 0, False
    for number, line in enumerate([*source.splitlines(), ""], 1):
        mark = re.match(r"\s*(`{3,}|~{3,})", line)
        if mark:
            fence = None if fence else mark[1]
            line = ""
        elif fence or line.startswith("<!--"):
            continue
        if line.strip() == "$$" or (line.strip().startswith("$$") != line.strip().endswith("$$") and "$$" in line):
            math = not math
            line = "MATH"
        elif math:
            continue
        if line.lstrip().startswith("|"):
            if not re.fullmatch(r"[\s|:-]+", line):
                for cell in re.split(r"(?<!\\)\|", line.strip().strip("|")):
                    if len(clean(cell).split()) > 3:
                        yield "table", f"{path}:{number}", clean(cell)
            line = ""
        new = re.match(r"\s*([-*:]|\d+\.)\s|#+ ", line)
        if block and (not line.strip() or new):
            yield (
                "heading" if block[0].startswith("#") else "md",
                f"{path}:{start}",
                clean(" ".join(block).lstrip("# ")),
            )
            block = []
        if line.strip():
            if not block:
                start = number
            block.append(re.sub(r"^\s*([-*:]|\d+\.)\s+|^> ?", "", line))


def paragraphs(text: str):
    """Yield (line offset, text) for the prose paragraphs of a docstring."""
    block, start, code = [], 0, False
    for number, line in enumerate([*text.splitlines(), ""]):
        if line.strip().startswith(">>>"):
            code = True
        if not line.strip():
            if block:
                yield start, clean(" ".join(block))
            block, code = [], False
            continue
        indented = line.startswith("    ") or line.strip().startswith("==")
        if code or (indented and not re.match(r"\s*\w[\w, *]*:\s", line) and number):
            continue
        if not block:
            start = number
        block.append(line.strip())


def strings(node: ast.AST):
    """Return the text of a string or f-string literal, with X for each placeholder, or None."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(v.value if isinstance(v, ast.Constant) else "X" for v in node.values)
    return None


def notebook(path: pathlib.Path):
    """Yield (kind, place, text) for the cells of a notebook; a place is "path, cell number:line"."""
    for number, cell in enumerate(json.loads(path.read_text())["cells"]):
        read = markdown if cell["cell_type"] == "markdown" else python
        for kind, place, text in read(path, "".join(cell["source"])):
            line = place.rpartition(":")[2]
            yield kind, f"{path}, cell {number}:{line}", text


def python(path: pathlib.Path, source: str):
    """Yield (kind, place, text) for docstrings, messages, help texts, test names and comments."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            doc = ast.get_docstring(node)
            if doc:
                line = node.body[0].lineno
                for index, (offset, text) in enumerate(paragraphs(doc)):
                    kind = "module" if isinstance(node, ast.Module) else "doc1" if index == 0 else "doc"
                    yield kind, f"{path}:{line + offset}", text
            name = getattr(node, "name", "")
            if name.startswith("test_"):
                yield "test", f"{path}:{node.lineno}", name[5:].replace("_", " ")
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            for arg in node.exc.args:
                text = strings(arg)
                if text and " " in text:
                    yield "message", f"{path}:{arg.lineno}", clean(text)
        if isinstance(node, ast.keyword) and node.arg == "help" and strings(node.value):
            yield "help", f"{path}:{node.value.lineno}", clean(strings(node.value))
    last = None
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and not re.match(r"#(!|:| noqa| type:| doctest| --)", token.string):
            text = token.string.lstrip("# ").strip()
            if last and token.start[0] == last[1] + 1 and token.start[1] == last[2]:
                last = (last[0], token.start[0], token.start[1], last[3] + " " + text)
            else:
                if last:
                    yield "comment", f"{path}:{last[0]}", clean(last[3])
                last = (token.start[0], token.start[0], token.start[1], text)
    if last:
        yield "comment", f"{path}:{last[0]}", clean(last[3])


def prose(roots: list[str]):
    """Yield (kind, place, text) for every Markdown file, notebook and Python file below the given paths."""
    for root in map(pathlib.Path, roots):
        for path in [root] if root.is_file() else sorted(root.rglob("*")):
            if SKIP & set(path.parts):
                continue
            if path.suffix == ".md":
                yield from markdown(path, path.read_text())
            elif path.suffix == ".ipynb":
                yield from notebook(path)
            elif path.suffix == ".py":
                yield from python(path, path.read_text())


PROSE = {"md", "module", "doc1", "doc", "comment", "help", "table"}
ALL = PROSE | {"message", "heading"}

# (rule, kinds, pattern, advice); the numbers are those of CONTRIBUTING.md
RULES = [
    ("R1-imports", {"module"}, r"(?:^|[.:;] )Imports? (?=[a-z])[^.]*", "delete: the import statements say it"),
    (
        "R2-vague",
        {"doc1"},
        r"^(?:The same (?:in|for|as|where|with|over|without|map where)\b|The same\b(?=,)|As |Of (?!the)|Itself|Both as)"
        r"[^.]{0,30}",
        "say what is returned, with type, shape or unit",
    ),
    ("R3-what", PROSE, r"(?:^|[.:;] )What (?![^.]*\?)\w+ \w+", "name the thing: 'The X that ...'"),
    (
        "R4-is-no",
        ALL,
        r"(?<![Tt]here )(?<!may )\b(?:is|are|was|were) no "
        r"(?!longer\b|more\b|less\b|need\b|reason\b|such\b|better\b|larger\b|smaller\b)[a-z]+",
        "'is not a ...'",
    ),
    (
        "R4-it-is-none",
        ALL,
        r"\b(?:it|that|they|which|what|this|of rank X) (?:is|are) none\b(?! of)|\bmay be none\b",
        "repeat the noun",
    ),
    (
        "R4-front",
        ALL,
        r"(?:(?:^|[.:;] )(?:Taken|Read|Demanded|Compiled|Measured|Refused|Held|Returned|Kept|Solved|Asked)"
        r"|\bmeasured) (?:are|is|were|was)\b",
        "subject first",
    ),
    ("R5-chain", PROSE - {"table"}, None, "at most one of ':' and ';' in a sentence; use a list"),
    ("R5-long", PROSE, None, "at most 40 words in a sentence"),
    (
        "R6-term",
        ALL,
        r"\btexts\b|\b(?:a|one|each|JSON) text\b|\btruth values?\b|\bextended floats?\b|\bbeside\b|\banew\b|\bdearer?\b"
        r"|\badapted (?:steps?|sizes?|step sizes?)\b|\bsizes? (?:is|are) adapted\b|\bplain (?:steps?|ones?)\b"
        r"|\bcertain (?:balls?|signs?|roots?)\b|\bnot known yet\b|\bnumbers that are not known\b"
        r"|\bas (?:it|they) (?:is|are|comes?) done\b|\bas they come\b|\btwins?\b|\bpassage of\b|\bso many\b|\bpeers\b"
        r"|\b(?:one|an) orders? more\b|\blanes? (?:that )?rests?\b|\bby the clock\b"
        r"|\bbut for (?:the|its|products|a)\b|\bintegrals? (?:is |are )?kept\b"
        r"|\bkeep(?:s|ing)? (?:an|the|first|its) (?:integral|energy|line)s?\b",
        "see the glossary",
    ),
    (
        "R3-riddle",
        ALL,
        r"\bnobody\b|\bnothing else should\b|\bwhatever interruption\b|\bfor one thing\b",
        "say who or what, and what happens otherwise",
    ),
    ("R6-stands", PROSE, r"\bstands? (?!for\b|alone\b|side\b)\w+", "'is', 'is listed', 'appears'"),
]
SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z(])")


def hits(kind: str, text: str):
    """Yield (rule, quotation, advice) for each violation in one paragraph."""
    for rule, kinds, pattern, advice in RULES:
        if kind not in kinds:
            continue
        if pattern:
            for match in re.finditer(pattern, text):
                yield rule, match[0].strip(" .:;,"), advice
            continue
        if re.match(r"(Parameters|Returns|Attributes|Raises|Examples|Notes|See Also|Yields) -{3,}", text):
            continue
        for sentence in SENTENCE.split(text):
            marks = re.findall(r"[;:](?=\s)", sentence)
            if rule == "R5-chain" and len(marks) > 1 and ";" in marks:
                yield rule, sentence[:100], advice
            if rule == "R5-long" and len(re.findall(r"[A-Za-z]{2,}", sentence)) > 40:
                yield rule, sentence[:100], advice


def main() -> int:
    """Run the command line and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", default=["."])
    for flag in ("--dump", "--summary", "--update"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--baseline")
    options = parser.parse_args()
    found = collections.defaultdict(list)
    for kind, place, text in prose(options.paths):
        if not text:
            continue
        if options.dump:
            print(kind, place, text, sep="\t")
            continue
        if kind == "test" or "prose: ok" in text:
            continue
        for rule, quote, advice in hits(kind, text):
            found[re.split(r", cell |:(?=\d+$)", place)[0], rule].append((place, quote, advice))
    if options.dump:
        return 0
    counts = {f"{path} {rule}": len(places) for (path, rule), places in sorted(found.items())}
    if options.summary:
        total, files = collections.Counter(), collections.Counter()
        for (_, rule), places in found.items():
            total[rule] += len(places)
            files[rule] += 1
        for rule in dict.fromkeys(rule for rule, *_ in RULES):
            print(f"{rule:12} {total[rule]:5} hits in {files[rule]:4} files")
        return 0
    if options.baseline and options.update:
        pathlib.Path(options.baseline).write_text(json.dumps(counts, indent=0, sort_keys=True) + "\n")
        return 0
    old = json.loads(pathlib.Path(options.baseline).read_text()) if options.baseline else {}
    risen = False
    for (path, rule), places in sorted(found.items()):
        if len(places) > old.get(f"{path} {rule}", 0):
            risen = True
            for place, quote, advice in places:
                print(f"{place}: {rule}: {quote!r}: {advice}")
    return int(risen)


if __name__ == "__main__":
    sys.exit(main())
