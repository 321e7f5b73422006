# In the guest: the camera driver with vivid, the kernel's virtual video device.
set -e
busybox rmmod vivid
# Two webcams, each with one webcam input.
busybox insmod /mod/vivid.ko n_devs=2 num_inputs=1,1 input_types=0,0 node_types=1,1
ls -l /dev/video*
camera_on_vivid look
camera_on_vivid formats
camera_on_vivid settings
camera_on_vivid busy
camera_on_vivid damaged
# Pulled out in the middle of a stream; comes back as the same device.
camera_on_vivid unplug >/tmp/unplug & driver=$!
i=0
until grep -q 'UNPLUGGED' /tmp/unplug; do
  i=$((i + 1))
  [ $i -lt 300 ] || { cat /tmp/unplug; echo "FAILED: nothing was said of the unplugged camera"; exit 1; }
  busybox usleep 100000
done
for i in 1 2 3 4 5 6 7 8 9 10; do  # the driver's search for its camera keeps the module in use at times
  busybox rmmod vivid && break
  busybox usleep 130000
done
busybox usleep 500000
busybox insmod /mod/vivid.ko n_devs=2 num_inputs=1,1 input_types=0,0 node_types=1,1
wait $driver || { cat /tmp/unplug; exit 1; }
cat /tmp/unplug
echo "camera: all held"
