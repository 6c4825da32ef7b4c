#!/usr/bin/env bash
# Checks the proofs, prints what the main theorems assume, extracts the checker and builds the program liehom-check.
# Usage: check.sh [FOLDER]; what is built goes to that folder, build/formal by default.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${1:-$here/../../build/formal}

packages="coq libcoq-mathcomp-ssreflect libcoq-mathcomp-algebra libcoq-mathcomp-field libcoq-mathcomp-real-closed
libcoq-mathcomp-zify libcoq-mathcomp-algebra-tactics ocaml-nox ocaml-findlib libzarith-ocaml-dev libyojson-ocaml-dev"
for tool in coqc ocamlfind; do
    command -v $tool >/dev/null || { echo "$tool is missing: apt-get install" $packages >&2; exit 1; }
done

mkdir -p "$build"
cp -r "$here"/_CoqProject "$here"/theories "$here"/Assumptions.v "$here"/Reals.v "$here"/ocaml "$build"
cd "$build"

coq() { coqc -w none -R theories Liehom "$@"; }
for file in $(grep '\.v$' _CoqProject); do
    echo "proof  $file"
    coq "$file"
done

coq Assumptions.v > assumptions.txt
theorems=$(grep -c '^Print Assumptions' Assumptions.v)
closed=$(grep -c '^Closed under the global context$' assumptions.txt || true)
[ "$closed" -eq "$theorems" ] || { cat assumptions.txt; echo "$closed of $theorems theorems are closed" >&2; exit 1; }
sed -n 's/^Print Assumptions \(.*\)\.$/theorem  \1:/p' Assumptions.v | paste -d' ' - assumptions.txt

# the real numbers of Coq's standard library, with these axioms and no others
if [ -e "$(coqc -where)/user-contrib/mathcomp/analysis/Rstruct.vo" ]; then
    coq Reals.v > reals.txt
    axioms="ClassicalDedekindReals.sig_forall_dec ClassicalDedekindReals.sig_not_dec Epsilon.epsilon_statement
    FunctionalExtensionality.functional_extensionality_dep"
    used=$(sed -n '2,$s/^\([A-Za-z][A-Za-z_.]*\).*/\1/p' reals.txt | sort)
    [ "$used" = "$(printf '%s\n' $axioms)" ] || { cat reals.txt; echo "other axioms than the expected ones" >&2; exit 1; }
    echo "theorem  check_sound_reals: the axioms of Coq's real numbers"
else
    echo "left out check_sound_reals: apt-get install libcoq-mathcomp-analysis"
fi

cd ocaml
coqc -w none -R ../theories Liehom Extraction.v
ocamlfind ocamlopt -package zarith,yojson -linkpkg integer.ml checker.mli checker.ml reader.ml propose.ml halfplane.ml dominance.ml \
    certificates.ml coq_file.ml main.ml -o ../liehom-check
echo "program $build/liehom-check"
