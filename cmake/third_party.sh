#!/usr/bin/env bash
# third_party.sh TREE PACKAGE...: writes TREE/THIRD-PARTY, which names the Debian packages whose libraries or headers TREE holds, with versions
# and licences, and TREE/licences with their texts, all from /usr/share/doc.
set -euo pipefail

tree=$1
shift
mkdir -p "$tree/licences"
cp -L /usr/share/common-licenses/* "$tree/licences/"
system=$(. /etc/os-release && echo "$PRETTY_NAME")
glibc=$(find "$tree" -name '*.so*' -type f -exec readelf --version-info {} + 2>/dev/null | grep -oE 'GLIBC_2\.[0-9]+' | sort -uV | tail -n 1)
{
    cat <<END
render2mpeg with its libraries, for any Linux of glibc ${glibc#GLIBC_} or later. bin/render2mpeg runs from wherever this folder lies; it needs /proc.

render2mpeg's own source is under the Apache License 2.0 (licences/Apache-2.0). The libraries in lib/ are those of $system, unchanged
but for paths; of packages ending in -dev the program holds compiled headers. FFmpeg is Debian's, under the GNU GPL: so this folder as a
whole is under the GNU GPL, version 3 or any later one (licences/GPL-3), the first version that the Apache License goes with.

Sources: Debian's archive keeps them under the names and versions in the third column (apt-get source NAME=VERSION).
Licences: as the package's copyright file lists them; that file is licences/PACKAGE.copyright.

END
    printf '%s\t%s\t%s\t%s\n' PACKAGE VERSION SOURCE LICENCES
    for package in "$@"; do
        file=/usr/share/doc/$package/copyright
        [ -s "$file" ] || { echo "third_party: $file is missing; the licence of $package is unknown" >&2 && exit 1; }
        cp -L "$file" "$tree/licences/$package.copyright"
        printf '%s\t%s\n' "$(dpkg-query -W -f '${Package}\t${Version}\t${source:Package}=${source:Version}\n' "$package" | head -n 1)" \
            "$(sed -nE 's/^License: *([^ ].*)$/\1/p' "$file" | sort -u | paste -sd, | sed -e 's/,/, /g' -e 's/^$/see that file/')"
    done
} >"$tree/THIRD-PARTY"
