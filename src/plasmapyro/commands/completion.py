"""`plasmapyro completion`: a script that lets a shell complete commands, options and file names."""

import argparse
import sys

from plasmapyro import cli

SCRIPT = """\
_plasmapyro() {{
    local words
    case "${{COMP_WORDS[1]}}" in
{cases}
        *) words="" ;;
    esac
    [ "$COMP_CWORD" = 1 ] && words="{commands}"
    COMPREPLY=($(compgen -W "$words" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o default -F _plasmapyro plasmapyro
"""
ZSH = "autoload -U +X compinit && compinit\nautoload -U +X bashcompinit && bashcompinit\n"


def run(options):
    """Run `plasmapyro completion`: the script on standard output."""
    top = cli.parser()
    found = next(one for one in top._actions if isinstance(one, argparse._SubParsersAction)).choices
    cases = [
        f'        {name}) words="{" ".join(word for one in command._actions for word in _words(one))}" ;;'
        for name, command in found.items()
    ]
    text = SCRIPT.format(cases="\n".join(cases), commands=" ".join([*found, "--help", "--version"]))
    sys.stdout.write((ZSH if options.shell == "zsh" else "") + text)


def _words(action):
    """What may be typed for an option or an argument."""
    return [*action.option_strings, *map(str, action.choices or ())]
