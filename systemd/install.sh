#!/bin/sh
# Installs this source tree as a service, upgrades it, and goes back to the release before.
#
#   make install              a release of its own below PREFIX/releases, which `current` points to
#   make rollback             `current` points to the release before; records and calibrations stay
#   make rollback STORE=back  also puts the run store back that the newer release has migrated
#
# PREFIX  where the releases lie               (/opt/cellctl)
# PYTHON  the interpreter, which the service's user must be able to run     (python3)
# INTO    a folder that stands for /, to try it all without touching the PC  (empty)
# SIGNERS whose signature of a bundle is accepted, in the form of ssh-keygen(1) ALLOWED SIGNERS;
#         `none` takes an unsigned one        (/etc/cellctl/allowed_signers)
set -eu

PREFIX=${PREFIX:-/opt/cellctl}
PYTHON=${PYTHON:-python3}
INTO=${INTO:-}
SIGNERS=${SIGNERS:-/etc/cellctl/allowed_signers}
HERE=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
RELEASES=$INTO$PREFIX/releases
STORE_FOLDER=$INTO/var/lib/cellctl

say() { printf '%s\n' "$*"; }
refuse() { printf 'nothing was changed: %s\n' "$*" >&2; exit 1; }

require_root() {
    [ -n "$INTO" ] || [ "$(id -u)" -eq 0 ] || refuse "this needs root: sudo make $1"
}

# A daemon that stops in order ends and seals its run. Nothing may be exchanged below one that runs.
require_standstill() {
    if [ -z "$INTO" ] && command -v systemctl >/dev/null && systemctl is-active --quiet cellctl; then
        refuse "the cell is running. When no run is open: sudo systemctl stop cellctl"
    fi
}

# Under a home directory systemd would answer with a bare 203/EXEC: the unit hides them.
require_interpreter() {
    real=$("$PYTHON" -c 'import os, sys; print(os.path.realpath(sys.executable))') ||
        refuse "there is no interpreter $PYTHON"
    case $real in
    /home/* | /root/* | /run/user/* | /tmp/*)
        [ -n "$INTO" ] || refuse "$real lies where the service may not look; name one of the" \
            "system: sudo make install PYTHON=/usr/bin/python3" ;;
    esac
}

# A bundle has a list of its files, with their sums and the signature of whoever packed it. A file
# that is not in the list would be installed unseen.
require_whole_bundle() {
    [ -e "$HERE/SHA256SUMS" ] || return 0
    if [ "$SIGNERS" != none ]; then
        [ -e "$HERE/SHA256SUMS.sig" ] ||
            refuse "this bundle is not signed. If that is wanted: make install SIGNERS=none"
        [ -e "$SIGNERS" ] || refuse "there is no $SIGNERS that says whose signature counts"
        signer=$(ssh-keygen -Y find-principals -f "$SIGNERS" -s "$HERE/SHA256SUMS.sig" 2>/dev/null |
            head -n 1)
        [ -n "$signer" ] || refuse "nobody in $SIGNERS has signed this bundle"
        ssh-keygen -q -Y verify -f "$SIGNERS" -I "$signer" -n cellctl-bundle \
            -s "$HERE/SHA256SUMS.sig" <"$HERE/SHA256SUMS" >/dev/null ||
            refuse "the signature does not fit the list of files"
    fi
    (cd "$HERE" && sha256sum --check --quiet --strict SHA256SUMS) ||
        refuse "files of this bundle are not those that were packed"
    listed=$(wc -l <"$HERE/SHA256SUMS")
    present=$(cd "$HERE" && find . -type f -not -name SHA256SUMS -not -name SHA256SUMS.sig | wc -l)
    [ "$listed" -eq "$present" ] || refuse "the bundle has $present files, its list $listed"
}

# Of a checkout, or what a release that is installed from says of itself.
revision() {
    if [ -e "$HERE/RELEASE" ]; then
        cat "$HERE/RELEASE"
        return
    fi
    git -c safe.directory="$HERE" -C "$HERE" describe --always --dirty --abbrev=12 --exclude='*' 2>/dev/null ||
        say source
}

release_name() {
    version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$HERE/pyproject.toml")
    say "$version-$(revision)"
}

copy_source() {
    if [ -e "$HERE/.git" ]; then
        git -c safe.directory="$HERE" -C "$HERE" ls-files -z
    else
        (cd "$HERE" && find . -type f -not -path './.venv*' -not -path './runs/*' -not -path './wheels/*' -print0)
    fi | tar -C "$HERE" --null -T - -cf - | tar -C "$1" --no-same-owner -xf -
}

build_release() {
    mkdir -p "$1"
    copy_source "$1"
    revision >"$1/RELEASE"
    "$PYTHON" -m venv "$1/.venv"
    # A bundle brings its packages; nothing is asked of a network then.
    if [ -d "$HERE/wheels" ]; then
        export PIP_NO_INDEX=1 PIP_FIND_LINKS="$HERE/wheels"
    fi
    "$1/.venv/bin/python" -m pip install --quiet --require-hashes -r "$1/requirements.lock"
    "$1/.venv/bin/python" -m pip install --quiet --no-deps --no-build-isolation -e "$1"
    chmod -R u=rwX,go=rX "$1"
    touch "$1/.complete"
}

# A link is exchanged in one step: a service that starts meanwhile finds the one or the other.
point() {
    ln -sfn "$2" "$1.new"
    mv -T "$1.new" "$1"
}

put() { install -D -m 644 "$1" "$INTO$2"; }
put_once() { [ -e "$INTO$2" ] || put "$1" "$2"; }

# Units and templates of a release. A cell file or drawing that is there is the cell's own.
put_files() {
    for unit in cellctl.service cellctl-hmi.service cellctl-forward.service; do
        # A release that `rollback` returns to may be older than a unit.
        [ -e "$1/systemd/$unit" ] || continue
        sed "s#/opt/cellctl/#$INTO$PREFIX/#" "$1/systemd/$unit" >"$RELEASES/unit"
        put "$RELEASES/unit" "/etc/systemd/system/$unit"
    done
    rm "$RELEASES/unit"
    put "$1/systemd/cellctl.sysusers" /usr/lib/sysusers.d/cellctl.conf
    put "$1/systemd/cellctl.tmpfiles" /usr/lib/tmpfiles.d/cellctl.conf
    put_once "$1/config/cell.toml" /etc/cellctl/cell.toml
    for drawing in "$1"/config/features/* "$1"/config/connectors/*; do
        put_once "$drawing" "/etc/cellctl/${drawing#"$1"/config/}"
    done
}

# Manual page and completion of a release, and its commands for everybody.
put_help() {
    program=$1/.venv/bin/cellctl
    share=$INTO/usr/share
    mkdir -p "$INTO/usr/local/bin" "$share/man/man1" "$share/bash-completion/completions" \
        "$share/zsh/vendor-completions" "$share/fish/vendor_completions.d"
    "$1/.venv/bin/python" -m cellctl.cli.help.man_page >"$share/man/man1/cellctl.1"
    _CELLCTL_COMPLETE=source_bash "$program" >"$share/bash-completion/completions/cellctl"
    _CELLCTL_COMPLETE=source_zsh "$program" >"$share/zsh/vendor-completions/_cellctl"
    _CELLCTL_COMPLETE=source_fish "$program" >"$share/fish/vendor_completions.d/cellctl.fish"
    # All variables of this script are shared, and `name` is that of the release.
    for command in cellctl cellctl-hmi; do
        ln -sfn "$INTO$PREFIX/current/.venv/bin/$command" "$INTO/usr/local/bin/$command"
    done
}

tell_the_system() {
    [ -z "$INTO" ] || return 0
    systemd-sysusers
    systemd-tmpfiles --create cellctl.conf
    [ -d /run/systemd/system ] || return 0
    systemctl daemon-reload
    # Page and forwarder go on beside a daemon that is stopped, with the release that they began with.
    systemctl try-restart cellctl-hmi cellctl-forward
}

install_release() {
    require_root install
    require_standstill
    require_interpreter
    require_whole_bundle
    name=$(release_name)
    release=$RELEASES/$name
    # One that was broken off is made anew, and so is one whose name does not say what is in it.
    case $name in *-dirty | *-source) rm -f "$release/.complete" ;; esac
    if [ -e "$release/.complete" ]; then
        say "release $name is there already"
    else
        rm -rf "$release"
        say "installing release $name"
        build_release "$release"
    fi
    put_files "$release"
    put_help "$release"
    before=$(readlink "$INTO$PREFIX/current" || true)
    # A link that leads nowhere is nothing to go back to.
    if [ -n "$before" ] && [ "$before" != "releases/$name" ] && [ -d "$INTO$PREFIX/$before" ]; then
        point "$INTO$PREFIX/previous" "$before"
    fi
    point "$INTO$PREFIX/current" "releases/$name"
    tell_the_system
    say "installed $name. Next:"
    say "  cellctl check $INTO/etc/cellctl/cell.toml"
    say "  cellctl doctor"
    say "  sudo systemctl enable --now cellctl"
}

# Which form of the run store a release knows, and which one there is.
known_form() {
    "$1/.venv/bin/python" -c \
        "from cellctl.records.database.schema_version import SCHEMA_VERSION; print(SCHEMA_VERSION)"
}
present_form() {
    "$1/.venv/bin/python" -c "import sqlite3, sys
with sqlite3.connect(f'file:{sys.argv[1]}?mode=ro', uri=True) as store:
    print(store.execute('PRAGMA user_version').fetchone()[0])" "$STORE_FOLDER/store.sqlite"
}

roll_back() {
    require_root rollback
    require_standstill
    previous=$(readlink "$INTO$PREFIX/previous") || refuse "there is no release before this one"
    current=$(readlink "$INTO$PREFIX/current")
    older=$INTO$PREFIX/$previous
    if [ -e "$STORE_FOLDER/store.sqlite" ]; then
        known=$(known_form "$older")
        if [ "$(present_form "$older")" -gt "$known" ]; then
            put_store_back "$STORE_FOLDER/store-schema-$known.sqlite"
        fi
    fi
    put_files "$older"
    put_help "$older"
    point "$INTO$PREFIX/current" "$previous"
    point "$INTO$PREFIX/previous" "$current"
    tell_the_system
    say "back at ${previous#releases/}; \`make rollback\` again returns to ${current#releases/}"
}

put_store_back() {
    [ -e "$1" ] || refuse "the older release cannot read this run store, and $1 is not there"
    [ "${STORE:-}" = back ] || refuse "the older release cannot read this run store. Its state" \
        "before the upgrade is in $1; runs made since would be set aside. If that is wanted:" \
        "sudo make rollback STORE=back"
    aside=$STORE_FOLDER/set-aside-$(date +%Y%m%dT%H%M%S)
    mkdir "$aside"
    for part in store.sqlite store.sqlite-wal store.sqlite-shm; do
        [ ! -e "$STORE_FOLDER/$part" ] || mv "$STORE_FOLDER/$part" "$aside/"
    done
    cp -p "$1" "$STORE_FOLDER/store.sqlite"
    say "the newer run store is in $aside"
}

case ${1:-} in
install) install_release ;;
rollback) roll_back ;;
name) release_name ;;
*)
    say "usage: install.sh install|rollback|name" >&2
    exit 2
    ;;
esac
