# In the guest: USB drivers on a real kernel. Ends with 0 if all held.
set -e
trap 'code=$?; [ $code = 0 ] || head -n 40 /tmp/*.log; exit $code' EXIT
holder() { for d in /sys/bus/usb/devices/*:1.0/driver; do basename "$(readlink "$d")"; done; }
ftdi() { for d in /sys/bus/usb/devices/*; do [ "$(cat $d/idVendor 2>/dev/null)" = 0403 ] && echo "$d"; done; true; }

# --- udev: the rule gives plugged-in devices to plugdev ---
echo 'plugdev:x:46:' >/etc/group
systemd-udevd --daemon
udevadm trigger
udevadm settle
node=$(printf '/dev/bus/usb/%03d/%03d' "$(cat "$(ftdi)/busnum")" "$(cat "$(ftdi)/devnum")")
[ "$(stat -c '%a %g' "$node")" = "660 46" ] || { echo "rule: $node is $(stat -c '%a %g' "$node")"; exit 1; }
echo "udev: $node is 660 plugdev"

# --- ENTTEC Pro behind qemu's FTDI chip: taken from ftdi_sio, lit, given back ---
ls /dev/ttyUSB0
case "$(holder)" in *ftdi_sio*) echo "ftdi_sio holds it" ;; *) echo "no ftdi_sio:" $(holder); exit 1 ;; esac
usb_driver enttec_pro set=128 life=active set=200 off print=off >/tmp/pro.log & pro=$!
for i in 1 2 3 4 5 6 7 8 9 10; do [ -e /dev/ttyUSB0 ] || break; sleep 0.2; done
[ ! -e /dev/ttyUSB0 ] || { echo "the serial port is still there"; exit 1; }
wait $pro
cat /tmp/pro.log
for i in 1 2 3 4 5 6 7 8 9 10; do [ ! -e /dev/ttyUSB0 ] || break; sleep 0.2; done
ls /dev/ttyUSB0

# --- a program that has the serial port open is named in the error, and keeps it ---
mkdir -p /var/lock
echo $$ >/var/lock/LCK..ttyUSB0
usb_driver enttec_pro life=faulted >/tmp/lock.log
cat /tmp/lock.log
grep -q "in use as ttyUSB0 by process $$" /tmp/lock.log
rm /var/lock/LCK..ttyUSB0
ls /dev/ttyUSB0

# --- uDMX behind vhci_hcd: plugged in late, lit, unplugged, plugged in again ---
usb_driver udmx life=faulted print=waiting life=active set=100 print=lit life=faulted print=gone life=active set=50 off >/tmp/udmx.log & driver=$!
until grep -q waiting /tmp/udmx.log; do sleep 0.1; done
udmx_on_vhci 0 >/tmp/widget1.log & widget=$!
for i in $(seq 100); do grep -q 'driver: lit' /tmp/udmx.log && break; sleep 0.1; done
cat /tmp/widget1.log
grep -q 'slot 1: 100' /tmp/widget1.log
kill $widget
for i in $(seq 100); do grep -q 'driver: gone' /tmp/udmx.log && break; sleep 0.1; done
grep -q 'driver: gone' /tmp/udmx.log
udmx_on_vhci 1 >/tmp/widget2.log & widget=$!
wait $driver
cat /tmp/udmx.log /tmp/widget2.log
grep -q 'slot 1: 50' /tmp/widget2.log
kill $widget
echo "usb: all held"
