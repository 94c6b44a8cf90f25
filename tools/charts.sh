#!/usr/bin/env bash
# Make the charts of docs/charts.md: the pictures, and under each what `fiberwalk chart` says. Seconds for each cloth: the first
# argument, or 300; the cloths: the further ones, or the four of the page.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

time=${1:-300}
shift || true
[ $# -gt 0 ] || set -- voile denim felt lining
cargo build --release --locked
mkdir -p assets/figures/charts target/charts
for cloth in "$@"; do
    folder=target/charts/$cloth
    # Separate fibers of a felt take minutes to draw.
    target/release/fiberwalk chart "$cloth" --packing random --time "${time}s" --force -o "$folder" > "$folder.txt.new" || exit
    mv "$folder.txt.new" "$folder.txt"
    cp "$folder/chart.svg" "assets/figures/charts/$cloth.svg"
    # Put the text between the marks of the cloth, without the names of the files.
    sed '/^$/,$d' "$folder.txt" > "$folder.findings"
    awk -v mark="$cloth" -v file="$folder.findings" '
        $0 == "<!-- " mark " -->" { print; print "```text"; while ((getline line < file) > 0) print line; print "```"; skip = 1; next }
        $0 == "<!-- end of " mark " -->" { skip = 0 }
        !skip' docs/charts.md > "$folder.md"
    cp "$folder.md" docs/charts.md
done
