#!/usr/bin/env bash
# shell_pages.sh PROGRAM FOLDER: writes the program's manual pages (render2mpeg.1 and one for each command) and its completion for bash,
# zsh and fish, all from what its --help says.
set -euo pipefail

program=$1 folder=$2
export LC_ALL=C
mkdir -p "$folder"
declare -A helps
helps[program]=$("$program" --help)
commands=$(printf '%s\n' "${helps[program]}" | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on && /^  [a-z]/ {print $1}')

for command in $commands; do helps[$command]=$("$program" "$command" --help); done
version=$("$program" --version | awk '{print $2; exit}')
help_of() { printf '%s\n' "${helps[${1:-program}]}"; } # of a command, or of the program

# One line for each option: short, long, values, what it says; split by tabs.
options_of() {
    help_of "$1" | awk '
        function flush() { if (long != "") print short "\t" long "\t" values "\t" text; long = "" }
        /^  (-[a-zA-Z],)?--[a-z]/ {
            flush()
            head = $0; text = ""
            if (i = match(substr(head, 3), /  +[^ ]/)) { name = substr(head, 3, i - 1); text = substr(head, i + 2); sub(/^ +/, "", text) }
            else if (length(head) > 30 && substr(head, 30, 1) == " ") { name = substr(head, 3, 27); text = substr(head, 31) }
            else name = substr(head, 3)
            sub(/ +$/, "", name); sub(/ \(required\)/, "", name); sub(/ \[=[^]]*\]/, "", name)
            values = ""
            if (i = index(name, " ")) { values = substr(name, i + 1); name = substr(name, 1, i - 1) }
            short = ""
            if (name ~ /^-[a-zA-Z],/) { short = substr(name, 1, 2); name = substr(name, 4) }
            long = name; next
        }
        /^                              / && long != "" { sub(/^ +/, ""); text = text (text == "" ? "" : " ") $0; next }
        { flush() }
        END { flush() }'
}

# Sets `words`, those that an option takes: of fixed=P% only what comes before the capital is certain; ranges and places are none.
words_of() {
    local word all
    words=''
    IFS='|' read -ra all <<<"$1"
    for word in "${all[@]}"; do
        if [[ $word != *..* && $word =~ ^[a-z0-9][a-z0-9.=-]* ]]; then words+="${words:+ }${BASH_REMATCH[0]}"; fi
    done
}
says() { help_of '' | awk -v c="$1" '/^Subcommands:/ {on = 1; next} /^$/ {on = 0}
    on && /^  [a-z]/ {mine = $1 == c; if (mine) {$1 = ""; sub(/^ /, ""); text = $0}; next}
    on && mine {sub(/^ +/, ""); text = text " " $0} END {print text}'; }

# The manual.
roff() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
# The last lines of a command's help; of the program's, those of all commands.
examples_of() {
    local of
    for of in ${1:-$commands}; do
        help_of "$of" | awk '/^Example: / {on = 1; sub(/^Example: /, "")} on && NF {line = line (line == "" ? "" : " ") $0} END {if (on) print line}'
    done
}
page() { # NAME COMMAND
    local name=$1 command=$2
    printf '.TH %s 1 "" "render2mpeg %s" "User Commands"\n.SH NAME\n' "${name^^}" "$version"
    printf '%s \\- %s\n.SH SYNOPSIS\n' "$(roff <<<"$name")" "$(help_of "$command" | sed -n 1p | sed 's/[.]$//' | roff)"
    help_of "$command" | sed -n 's/^Usage: //p' | roff
    printf '.SH DESCRIPTION\n.nf\n'
    help_of "$command" | tail -n +3 | sed '/^Example: /,$d' | roff
    printf '.fi\n.SH EXAMPLES\n.nf\n'
    examples_of "$command" | roff
    printf '.fi\n.SH SEE ALSO\n'
    for other in '' $commands; do printf '%s\n' "\\fBrender2mpeg${other:+\\-$other}\\fP(1)"; done | paste -sd, | sed 's/,/, /g'
}
page render2mpeg '' >"$folder/render2mpeg.1"
for command in $commands; do page "render2mpeg-$command" "$command" >"$folder/render2mpeg-$command.1"; done

# bash
{
    echo '# Completion of render2mpeg for bash, made from its --help.'
    echo '_render2mpeg() {'
    echo "    local current=\${COMP_WORDS[COMP_CWORD]} previous=\${COMP_WORDS[COMP_CWORD - 1]} words=''"
    echo '    COMPREPLY=()'
    echo '    if [ "$COMP_CWORD" -eq 1 ]; then'
    echo "        mapfile -t COMPREPLY < <(compgen -W '$(echo $commands) --help --version' -- \"\$current\")"
    echo '        return'
    echo '    fi'
    echo '    case "${COMP_WORDS[1]} $previous" in'
    for command in $commands; do
        options_of "$command" | while IFS= read -r line; do
            IFS=$'\x1f' read -r short long values _ <<<"${line//$'\t'/$'\x1f'}"
            words_of "$values"
            [ -z "$words" ] || echo "        '$command $long'${short:+ | '$command $short'}) words='$words' ;;"
        done
    done
    echo '    esac'
    echo '    if [ -z "$words" ] && [[ $current == -* ]]; then'
    echo '        case "${COMP_WORDS[1]}" in'
    for command in $commands; do echo "            $command) words='$(options_of "$command" | cut -f2 | paste -sd' ')' ;;"; done
    echo '        esac'
    echo '    fi'
    echo '    if [ -n "$words" ]; then'
    echo '        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")'
    echo '    else'
    echo '        mapfile -t COMPREPLY < <(compgen -f -- "$current")'
    echo '    fi'
    echo '}'
    echo 'complete -o filenames -F _render2mpeg render2mpeg'
} >"$folder/render2mpeg.bash"

# zsh
{
    echo '#compdef render2mpeg'
    echo '# Completion of render2mpeg for zsh, made from its --help.'
    echo 'if (( CURRENT == 2 )); then'
    echo '    local -a commands=('
    for command in $commands; do echo "        '$command:$(says "$command" | sed "s/'/'\\\\''/g")'"; done
    echo '    )'
    echo "    _describe command commands -- '(--help --version)'"
    echo '    return'
    echo 'fi'
    echo 'local command=$words[2]'
    echo 'shift words'
    echo '(( CURRENT-- ))'
    echo 'case $command in'
    for command in $commands; do
        echo "    $command)"
        echo '        _arguments \'
        options_of "$command" | while IFS= read -r line; do
            IFS=$'\x1f' read -r short long values text <<<"${line//$'\t'/$'\x1f'}"
            text=$(sed -e 's/[]:\\[]/\\&/g' -e "s/'/'\\\\''/g" <<<"$text")
            words_of "$values"
            action=''
            [ -z "$values" ] || action=":$(sed 's/[]:\\[]/\\&/g' <<<"${values%% *}"):_files"
            [ -z "$words" ] || action=":value:($words)"
            echo "            '$long[$text]$action' \\"
            [ -z "$short" ] || echo "            '$short[$text]$action' \\"
        done
        echo "            '*:file:_files'"
        echo '        ;;'
    done
    echo 'esac'
} >"$folder/_render2mpeg"

# fish
{
    echo '# Completion of render2mpeg for fish, made from its --help.'
    echo 'complete -c render2mpeg -n __fish_use_subcommand -l help'
    echo 'complete -c render2mpeg -n __fish_use_subcommand -l version'
    for command in $commands; do
        echo "complete -c render2mpeg -n __fish_use_subcommand -f -a $command -d '$(says "$command" | sed "s/[\\\\']/\\\\&/g")'"
        options_of "$command" | while IFS= read -r line; do
            IFS=$'\x1f' read -r short long values text <<<"${line//$'\t'/$'\x1f'}"
            words_of "$values"
            echo "complete -c render2mpeg -n '__fish_seen_subcommand_from $command' -l ${long#--}${short:+ -s ${short#-}}$(
                [ -z "$words" ] || printf " -x -a '%s'" "$words"
                [ -n "$words" ] || [ -z "$values" ] || printf ' -r'
            ) -d '$(sed "s/[\\\\']/\\\\&/g" <<<"$text")'"
        done
    done
} >"$folder/render2mpeg.fish"
