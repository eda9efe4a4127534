#!/bin/sh
# Packs one archive from which a PC without any network is installed:
#
#   make bundle KEY=~/.ssh/id_ed25519     dist/cellctl-NAME.tar.gz: source, wheels, licences, bill of materials
#
# It holds SHA256SUMS of every file and, with KEY, a signature of that list (ssh-keygen -Y sign). There:
#
#   tar -xf cellctl-NAME.tar.gz && cd cellctl-NAME
#   sudo make install PYTHON=/usr/bin/python3 SIGNERS=/etc/cellctl/allowed_signers
#
# The wheels are those of this machine's kind and of the Python that packs them.
set -eu

PYTHON=${PYTHON:-python3}
KEY=${KEY:-}
HERE=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
NAME=cellctl-$("$HERE/systemd/install.sh" name)
FOLDER=$HERE/dist/$NAME

[ -z "$KEY" ] || [ -r "$KEY" ] || {
    printf '%s\n' "nothing was packed: there is no key $KEY" >&2
    exit 1
}
rm -rf "$FOLDER"
mkdir -p "$FOLDER/wheels"
git -C "$HERE" ls-files -z | tar -C "$HERE" --null -T - -cf - | tar -C "$FOLDER" -xf -
printf '%s\n' "${NAME#cellctl-*-}" >"$FOLDER/RELEASE"
"$PYTHON" -m pip download --quiet --require-hashes -r "$HERE/requirements.lock" -d "$FOLDER/wheels"
"$PYTHON" -m cellctl.bill_of_materials "$FOLDER/wheels" "$FOLDER"
(cd "$FOLDER" && find . -type f -print0 | LC_ALL=C sort -z | xargs -0 sha256sum) >"$HERE/dist/sums"
mv "$HERE/dist/sums" "$FOLDER/SHA256SUMS"
if [ -n "$KEY" ]; then
    ssh-keygen -q -Y sign -f "$KEY" -n cellctl-bundle "$FOLDER/SHA256SUMS"
else
    printf '%s\n' "without KEY the bundle is not signed: whoever installs it has to say so" >&2
fi
tar -C "$HERE/dist" -czf "$HERE/dist/$NAME.tar.gz" "$NAME"
rm -rf "$FOLDER"
printf '%s\n' "dist/$NAME.tar.gz"
