#!/usr/bin/env bash
# Writes the manual page and the shell completions of the program, made of what it says of itself with --help.
#
#   document_program.sh PROGRAM FOLDER    FOLDER/burnish.1, burnish.bash, _burnish (zsh), burnish.fish
set -euo pipefail

fail() { echo "document_program: $1" >&2; exit 1; }
[ $# -eq 2 ] || fail "expected PROGRAM FOLDER"
program=$1 folder=$2
mkdir -p "$folder"
table=$(mktemp)
trap 'rm -f "$table"' EXIT

# Help -> lines "kind, command, name, value, text", separated by tabs; kind is about (of a command), positional or option. An
# entry of a help is "  -o,--output FILE (required)   text"; a long one has its text on the lines below.
# shellcheck disable=SC2016  # awk reads the dollar signs
entries='
function flush() {
    if (name != "") print kind, command, name, value, text
    name = value = text = ""
}
BEGIN { OFS = "\t"; kind = "about" }
/^Usage:/ { if (kind == "about") print kind, command, "", "", about; kind = ""; next }
kind == "about" && NF { about = about (about == "" ? "" : " ") $0; next }
/^Positionals:/ { flush(); kind = "positional"; next }
/^(Subcommands|Commands):/ { flush(); kind = ""; next }
/^[A-Z].*:$/ { flush(); kind = "option"; next }
(kind == "option" && /^  -/) || (kind == "positional" && /^  [^ ]/) {
    flush()
    line = substr($0, 3)
    # Its text begins in column 35. One space is before it where the head fills its column; a longer head stands alone.
    at = substr(line, 32) ~ /^ [^ [(]/ ? 32 : match(line, /   *[^ ]/)
    head = at ? substr(line, 1, at - 1) : line
    sub(/ +$/, "", head)
    text = at ? substr(line, at) : ""
    sub(/^ +/, "", text)
    at = index(head, " ")
    name = at ? substr(head, 1, at - 1) : head
    value = at ? substr(head, at + 1) : ""
    next
}
name != "" && /^    / { line = $0; sub(/^ +/, "", line); text = text (text == "" ? "" : " ") line; next }
END { flush() }
'
help_of() { "$program" "$@" --help-all 2>/dev/null || "$program" "$@" --help; }
commands=$("$program" --help | awk '/^(Subcommands|Commands):/ { on = 1; next } on && /^  [a-z]/ { print $1 }')
[ -n "$commands" ] || fail "$program --help lists no commands"
"$program" --help | awk -v command=burnish "$entries" >"$table"
for command in $commands; do help_of "$command" | awk -v command="$command" "$entries" >>"$table"; done

# shellcheck disable=SC2016
manual='
function roff(s) { gsub(/\\/, "\\e", s); gsub(/-/, "\\-", s); sub(/^[.'"'"']/, "\\\\\\&&", s); return s }
function synopsis(command,    i, s) {
    s = ".B burnish " command
    for (i = 1; i <= positionals[command]; i++) s = s "\n.I " roff(positional[command, i])
    return s "\n.RI [ options ]"
}
BEGIN { FS = "\t" }
$2 != previous { order[++count] = $2; previous = $2 }
$1 == "about" { about[$2] = $5 }
$1 == "positional" { positional[$2, ++positionals[$2]] = $3 }
$1 != "about" {
    sub(/,/, ", ", $3)
    body[$2] = body[$2] ".TP\n.BI \"" roff($3) "\"" ($4 == "" ? "" : " \" " roff($4) "\"") "\n"
    body[$2] = body[$2] ($5 == "" ? "\\&" : roff($5)) "\n"
}
END {
    print ".TH BURNISH 1 \"\" \"" version "\" \"User Commands\""
    print ".SH NAME\nburnish \\- recovers the textures of materials from images"
    print ".SH SYNOPSIS"
    for (i = 2; i <= count; i++) print synopsis(order[i]) (i < count ? "\n.br" : "")
    print ".SH DESCRIPTION\n" roff(about["burnish"])
    print ".SH OPTIONS\n" body["burnish"] ".SH COMMANDS"
    for (i = 2; i <= count; i++) print ".SS burnish " order[i] "\n" roff(about[order[i]]) "\n" body[order[i]]
    print ".SH EXIT STATUS\n0: done; 2: wrong usage; 65: input that cannot be used; 70: a defect of the program;"
    print "73: an output that cannot be written; 74: standard output or a file that cannot be written or read;"
    print "75: stopped by a signal, \\-\\-resume goes on; 77: refused by a limit."
}
'
awk -v version="$("$program" --version | awk '{ print $1, $2 }')" "$manual" "$table" | sed '/^$/d' >"$folder/burnish.1"

# What a value offers: its alternatives, "FILE" where it is a file or a folder, "TEXT" for others, nothing for a flag.
# shellcheck disable=SC2016
values='
function offers(value,    v) {
    v = value
    sub(/ *\(.*/, "", v)
    sub(/ *\[.*/, "", v)
    if (v == "") return ""
    if (v ~ /^[a-z0-9_.-]+(\|[a-z0-9_.-]+)+$/) { gsub(/\|/, " ", v); return v }
    return v ~ /FILE|IMAGE|DIR|PATH|\.exr|\.json|xml/ ? "FILE" : "TEXT"
}
'
# shellcheck disable=SC2016
bash_completion='
BEGIN { FS = "\t" }
$1 == "about" && $2 != "burnish" { commands = commands (commands == "" ? "" : " ") $2 }
$1 == "option" {
    names = $3
    gsub(/,/, " ", names)
    options[$2] = options[$2] (options[$2] == "" ? "" : " ") names
    offered = offers($4)
    n = split(names, each, " ")
    if (offered != "" && offered !~ /^(FILE|TEXT)$/)
        for (i = 1; i <= n; i++) choices = choices "        \"" $2 " " each[i] "\") offered=\"" offered "\" ;;\n"
}
END {
    print "# Completes the commands and options of burnish in bash.\n_burnish() {"
    print "    local word=${COMP_WORDS[COMP_CWORD]} command=burnish offered=\"\""
    print "    [ \"$COMP_CWORD\" -gt 1 ] && command=${COMP_WORDS[1]}"
    print "    case \"$command ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" choices "    esac"
    print "    if [ -z \"$offered\" ]; then\n        case \"$command\" in"
    print "        burnish) offered=\"" commands " " options["burnish"] "\" ;;"
    n = split(commands, each, " ")
    for (i = 1; i <= n; i++) print "        " each[i] ") [[ $word == -* ]] && offered=\"" options[each[i]] "\" ;;"
    print "        esac\n    fi"
    print "    mapfile -t COMPREPLY < <(compgen -W \"$offered\" -- \"$word\")\n}"
    print "complete -o default -F _burnish burnish"
}
'
awk "$values$bash_completion" "$table" >"$folder/burnish.bash"

# shellcheck disable=SC2016
zsh_completion='
function quoted(s) { gsub(/'"'"'/, "'"'\\\\''"'", s); gsub(/[\[\]:]/, "\\\\&", s); return s }
BEGIN { FS = "\t"; print "#compdef burnish\n# Completes the commands and options of burnish in zsh." }
$1 == "about" && $2 != "burnish" { commands = commands "    '"'"'" $2 ":" quoted($5) "'"'"'\n" }
$1 == "option" {
    offered = offers($4)
    action = offered == "" ? "" : offered == "FILE" ? ":file:_files" : offered == "TEXT" ? ":value: " : ":value:(" offered ")"
    n = split($3, each, ",")
    for (i = 1; i <= n; i++)
        arguments[$2] = arguments[$2] " \\\n            '"'"'*" each[i] "[" quoted($5) "]" action "'"'"'"
}
END {
    print "local -a commands=(\n" commands ")"
    print "if (( CURRENT == 2 )); then\n    _describe command commands\n    _arguments" arguments["burnish"] "\n    return\nfi"
    print "case $words[2] in"
    for (command in arguments)
        if (command != "burnish")
            print "    " command ")\n        _arguments" arguments[command] " \\\n            '"'"'*:file:_files'"'"' ;;"
    print "esac"
}
'
awk "$values$zsh_completion" "$table" >"$folder/_burnish"

# shellcheck disable=SC2016
fish_completion='
function quoted(s) { gsub(/[\\'"'"']/, "\\\\&", s); return "'"'"'" s "'"'"'" }
BEGIN { FS = "\t"; print "# Completes the commands and options of burnish in fish." }
$1 == "about" && $2 != "burnish" { print "complete -c burnish -n __fish_use_subcommand -f -a " $2 " -d " quoted($5) }
$1 == "option" {
    line = "complete -c burnish -n "
    line = line ($2 == "burnish" ? "__fish_use_subcommand" : quoted("__fish_seen_subcommand_from " $2))
    n = split($3, each, ",")
    for (i = 1; i <= n; i++) line = line (each[i] ~ /^--/ ? " -l " substr(each[i], 3) : " -s " substr(each[i], 2))
    offered = offers($4)
    line = line (offered == "" ? "" : offered == "FILE" ? " -r -F" : offered == "TEXT" ? " -x" : " -x -a " quoted(offered))
    print line " -d " quoted($5)
}
'
awk "$values$fish_completion" "$table" >"$folder/burnish.fish"
