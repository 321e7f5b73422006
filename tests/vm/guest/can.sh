# In the guest: the canopen driver and the simulated axes as two processes on a real SocketCAN interface, with candump
# and cansend as witnesses. Then a controller with states.
set -e
witness=/tmp/dump
fail() { echo "FAILED: $*"; tail -n 30 $witness; exit 1; }
# One frame must match this extended regular expression, such as "705#05".
seen() { grep -qE " $1\$" $witness || fail "candump has not seen $1"; }

/bin/ip link add vcan0 type vcan
/bin/ip link set vcan0 up
candump -L vcan0 >/tmp/dump &
dump=$!
can_axes nodes vcan0 >/tmp/nodes &
nodes=$!

echo "--- a head is set up, homed and turned"
can_axes drive vcan0 25 -33 60 || fail "the head has not arrived"
kill $nodes
wait $nodes || fail "the nodes ended badly"
cat /tmp/nodes
grep -qE '^NODES pan (25.0|24.9)[0-9]* tilt -(33.0|32.9)' /tmp/nodes || fail "the joints are elsewhere"
seen '000#8005'; seen '000#0105'; seen '000#0106'                  # NMT: pre-operational, start
seen '705#00'; seen '705#05'; seen '77F#05'                        # boot-up, heartbeats of node and master
seen '605#4000100000000000'; seen '585#4300100092010200'           # SDO: device type
seen '605#2B07600003000000'; seen '585#6007600000000000'           # quick stop when the master dies
seen '605#2316100[1]2C017F00'; seen '605#2F60600006000000'         # watches the master, 300 ms; homing mode
seen '605#2F60600001000000'                                        # profile position
seen '080#'; seen '205#3F00[0-9A-F]{8}'                            # SYNC; a set-point, with immediate change
seen '185#37[0-9A-F]{12}'                                          # operation enabled

echo "--- cansend asks a drive, and the driver dies while the head turns"
kill $dump
witness=/tmp/dump.2
candump -L vcan0 >$witness &
dump=$!
can_axes nodes vcan0 >/tmp/nodes &
nodes=$!
can_axes drive vcan0 80 50 60 >/tmp/drive &
drive=$!
i=0
until grep -qE ' 185#37[0-9A-F]{10}06$' $witness; do  # enabled, in homing mode
  i=$((i + 1))
  [ $i -lt 600 ] || fail "no homing: $(cat /tmp/drive)"
  busybox usleep 100000
done
busybox usleep 500000
cansend vcan0 605#4041600000000000
busybox usleep 200000
seen '585#4B416000[0-9A-F]{8}'
kill -9 $drive
wait $drive || true
sleep 2
seen '085#3081010000000000'                                        # emergency: heartbeat of the master lost
seen '086#3081010000000000'
kill $nodes
wait $nodes
cat /tmp/nodes
grep -qE 'speeds -?0.00 -?0.00 status 0.17 0.17$' /tmp/nodes || fail "not in quick stop"

echo "--- bus-off is said"
can_axes drive vcan0 0 0 4 >/tmp/drive &
drive=$!
sleep 1
cansend vcan0 20000040#0000000000000000
wait $drive && fail "nobody was there"
cat /tmp/drive
grep -q 'the controller is bus-off' /tmp/drive || fail "nothing said of bus-off"
kill $dump

echo "--- a controller with states"
can_states
