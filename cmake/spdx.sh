#!/usr/bin/env bash
# spdx.sh VERSION PACKAGE...: prints what a package of render2mpeg holds as an SPDX 2.3 document of tags and values: the program, the Debian
# packages PACKAGE..., whose libraries lie beside it, and those whose headers are compiled into it. `spdx.sh --headers` prints these.
# $SOURCE_DATE_EPOCH is the document's time.
set -euo pipefail

headers=(libcli11-dev libglm-dev nlohmann-json3-dev)
[ "${1:-}" != --headers ] || { printf '%s\n' "${headers[@]}" && exit; }
version=$1
shift

entry() { # NAME VERSION ID LICENCE
    printf '\nPackageName: %s\nSPDXID: SPDXRef-%s\nPackageVersion: %s\nPackageDownloadLocation: NOASSERTION\nFilesAnalyzed: false\n' "$1" "$3" "$2"
    printf 'PackageLicenseConcluded: NOASSERTION\nPackageLicenseDeclared: %s\nPackageCopyrightText: NOASSERTION\n' "$4"
}
entries() {
    local name package kind
    entry render2mpeg "$version" render2mpeg Apache-2.0
    echo "Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-render2mpeg"
    for name in $(printf '%s\n' "${headers[@]}" "$@" | sort -u); do
        kind=CONTAINS
        [[ " ${headers[*]} " != *" $name "* ]] || kind=STATIC_LINK
        package=$(dpkg-query -W -f '${Version}\n' "$name" | head -n 1)
        # An identifier has letters, digits, dots and hyphens; an address writes + and ~ otherwise.
        entry "$name" "$package" "${name//+/.plus}" NOASSERTION
        echo "ExternalRef: PACKAGE-MANAGER purl pkg:deb/debian/${name//+/%2B}@$(sed 's/+/%2B/g; s/:/%3A/g' <<<"$package")"
        echo "Relationship: SPDXRef-render2mpeg $kind SPDXRef-${name//+/.plus}"
    done
}

text=$(entries "$@")
cat <<END
SPDXVersion: SPDX-2.3
DataLicense: CC0-1.0
SPDXID: SPDXRef-DOCUMENT
DocumentName: render2mpeg-$version
DocumentNamespace: https://spdx.org/spdxdocs/render2mpeg-$version-$(sha256sum <<<"$text" | cut -c1-32)
Creator: Tool: render2mpeg-spdx
Created: $(date --utc --date="@$SOURCE_DATE_EPOCH" +%Y-%m-%dT%H:%M:%SZ)
$text
END
