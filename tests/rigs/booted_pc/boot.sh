#!/bin/bash
# Called by pc.py within new namespaces: lays a writable layer over the root of this machine, furnishes
# what the kernel gives to a booted PC, and becomes its systemd.
#   boot.sh BOX PYTHON SOURCE PACKAGES
set -euo pipefail
box=$1 python=$2 source=$3 packages=$4
root=$box/root

mount -t tmpfs layer "$box/layer"
mkdir "$box/layer/written" "$box/layer/scratch" # an overlay wants both on one file system
mount -t overlay pc -o "lowerdir=/,upperdir=$box/layer/written,workdir=$box/layer/scratch" "$root"

mount -t proc proc "$root/proc"
mount -t sysfs -o ro sysfs "$root/sys"
mount -t cgroup2 cgroup2 "$root/sys/fs/cgroup"
mount -t tmpfs -o mode=755 run "$root/run"
mount -t tmpfs tmp "$root/tmp"
mount -t tmpfs -o mode=755 dev "$root/dev"
for device in null zero full random urandom tty; do
    touch "$root/dev/$device"
    mount --bind "/dev/$device" "$root/dev/$device"
done
mkdir "$root/dev/pts" "$root/dev/shm"
mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
ln -s pts/ptmx "$root/dev/ptmx"
mount -t tmpfs shm "$root/dev/shm"

# A release as `make install` leaves it, from what this very test runs on. The service must see
# nothing below a home directory, where interpreter and checkout often are.
for name in python source packages; do
    mkdir -p "$root/opt/cellctl/$name"
    mount --bind "${!name}" "$root/opt/cellctl/$name"
done
cp -a "$box/release/." "$root/"
# An interpreter that was built with a shared library looks for it where it was built, which is hidden
# as well; it would take that of the distribution, of another version.
echo /opt/cellctl/python/lib >"$root/etc/ld.so.conf.d/000-cellctl.conf"
chroot "$root" /sbin/ldconfig

# Only what the units under test need is started: the machine has other services of its own.
units=$root/etc/systemd/system
printf '[Unit]\nRequires=systemd-journald.service dbus.socket\nAfter=systemd-journald.service dbus.socket\nAllowIsolate=yes\n' >"$units/tested.target"
for asleep in udevd timesyncd resolved networkd logind firstboot; do
    ln -sf /dev/null "$units/systemd-$asleep.service"
done
rm -f "$root/etc/machine-id"
tr -d - </proc/sys/kernel/random/uuid >"$root/etc/machine-id"
ip link set lo up
exec env -i container=tested PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    chroot "$root" /lib/systemd/systemd --unit=tested.target --log-target=journal --show-status=no </dev/null
