#!/usr/bin/env bash
# Make the table of presets in the README: preparation, memory and speed as `measure` models them, with the median and the
# range of rounds in alternation. Rounds: the first argument, or 5; the cloths: the further ones, or all of yarns and felt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

rounds=${1:-5}
shift || true
[ $# -gt 0 ] || set -- charmeuse denim dimout gabardine jersey linen lining muslin rib sheer voile felt
cargo build --release --locked
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The number behind a key of the last result, at a depth of so many spaces.
number() { sed -n "s/^ \{$2\}\"$1\": \([0-9.e+-]*\),*\$/\1/p" "$folder/out/summary.json"; }

for ((round = 0; round < rounds; round++)); do
    for cloth in "$@"; do
        target/release/fiberwalk measure "$cloth" --walks 40000 --engine gpu --force -o "$folder/out" > "$folder/log" 2>&1 \
            || { cat "$folder/log" >&2; exit 1; }
        echo "$(number prepare 4) $(number peak_bytes 2) $(number walk 4) $(number walks 2) $(number tentative_events 2)" \
            "$(number collisions 2)" >> "$folder/$cloth"
    done
done

# Median, smallest and largest of numbers, one a line.
spread() {
    sort -g | awk '
        function two(x) { return x < 99.5 ? sprintf("%.2g", x) : sprintf("%.0f", x) }
        { all[NR] = $1 }
        END { printf "%s (%s … %s)", two(all[int((NR + 1) / 2)]), two(all[1]), two(all[NR]) }'
}

echo "| preset | preparation, s | peak memory, MiB | 10⁶ walks/s | 10⁶ events/s | 10⁶ hits/s |"
echo "|---|---|---|---|---|---|"
for cloth in "$@"; do
    of() { awk "{ print $1 }" "$folder/$cloth" | spread; }
    peak=$(awk '{ if ($2 > most) most = $2 } END { printf "%.0f", most / 1048576 }' "$folder/$cloth")
    echo "| $cloth | $(of '$1') | $peak | $(of '$4 / $3 / 1e6') | $(of '$5 / $3 / 1e6') | $(of '$6 / $3 / 1e6') |"
done
