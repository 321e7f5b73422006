// Both ends of a CAN bus, each in its own process on a real SocketCAN interface:
//   can_axes nodes IF                     two simulated axes, nodes 5 and 6, until SIGTERM; then prints their angles
//   can_axes drive IF PAN TILT SECONDS    the canopen driver; prints changes, exits 0 once the head has arrived
#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "drivers/can/canopen_driver.h"
#include "sim/wire/can/axis_bus.h"
#include "tests/drivers/test_rig.h"

namespace {

using namespace luxrig;
using std::chrono::milliseconds;

volatile std::sig_atomic_t stop_asked = 0;
void ask_to_stop(int) { stop_asked = 1; }

Time real_now() { return Time{} + std::chrono::steady_clock::now().time_since_epoch(); }

Rig head_on(const std::string& interface_name) {
  Rig rig = rig_with(bus_of("canopen", {{"interface", interface_name}, {"homing_speed_percent", std::int64_t{50}}}));
  rig.buses.push_back(bus_of("sacn"));
  rig.buses[1].name = "lamps";
  Fixture& head = add_axes(add_dmx(rig, "head", 1, 1), 5, 6);
  head.bus = 1;
  head.range = {rad_from_deg(-90), rad_from_deg(90), rad_from_deg(-60), rad_from_deg(60)};
  head.pan_speed_rad_s = head.tilt_speed_rad_s = rad_from_deg(60);
  head.axes->pan = {5, 500, rad_from_deg(-95), rad_from_deg(120)};
  head.axes->tilt = {6, -400, rad_from_deg(65), rad_from_deg(120)};
  return rig;
}

int open_raw(const char* interface_name) {
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface_name));
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::perror(interface_name);
    std::exit(2);
  }
  return fd;
}

int nodes(const char* interface_name) {
  const Rig rig = head_on(interface_name);
  const Fixture& head = rig.fixtures[0];
  const int fd = open_raw(interface_name);
  sim::AxisNode pan(5, sim::axis_truth(head.axes->pan, head.range.pan_min_rad, head.range.pan_max_rad), 0, 1000);
  sim::AxisNode tilt(6, sim::axis_truth(head.axes->tilt, head.range.tilt_min_rad, head.range.tilt_max_rad), 0, 1000);
  Time now = real_now();
  for (sim::AxisNode* node : {&pan, &tilt}) node->set_power(now, true);
  while (!stop_asked) {
    pollfd wait{fd, POLLIN, 0};
    ::poll(&wait, 1, 1);
    for (; now + milliseconds(1) <= real_now(); now += milliseconds(1)) {
      for (sim::AxisNode* node : {&pan, &tilt}) node->step(now, false);
    }
    can_frame raw{};
    while (::read(fd, &raw, sizeof raw) == sizeof raw) {
      if (raw.can_id > 0x7FF) continue;
      for (sim::AxisNode* node : {&pan, &tilt}) node->receive(now, sim::bus_frame(raw.can_id, {raw.data, raw.can_dlc}));
    }
    for (sim::AxisNode* node : {&pan, &tilt}) {
      for (const sim::BusFrame& frame : node->take_sent()) {
        can_frame out{};
        out.can_id = frame.id;
        out.can_dlc = frame.size;
        std::copy(frame.data.begin(), frame.data.end(), out.data);
        if (::write(fd, &out, sizeof out) != sizeof out) std::perror("nodes: write");
      }
    }
  }
  fmt::print("NODES pan {:.2f} tilt {:.2f} speeds {:.2f} {:.2f} status {:04X} {:04X}\n", pan.drive().joint_deg(),
             tilt.drive().joint_deg(), pan.drive().speed_deg_s(), tilt.drive().speed_deg_s(), pan.drive().statusword(),
             tilt.drive().statusword());
  return 0;
}

int drive(const char* interface_name, double pan_deg, double tilt_deg, double seconds) {
  const Rig rig = head_on(interface_name);
  const auto driver = make_canopen(rig, 0, std::nullopt);
  const AimCommand aim{0, {rad_from_deg(pan_deg), rad_from_deg(tilt_deg)}};
  std::vector<std::string> said(3);
  Time now = real_now(), well_since = now;
  const Time end = now + from_seconds(seconds);
  (void)driver->activate(now);
  bool well = false;
  for (; now < end && !stop_asked; now = real_now()) {
    well = driver->mover()->move(now, {&aim, 1}).has_value();
    if (!well) well_since = now;
    const std::vector<Health> health = driver->health(now);
    for (std::size_t i = 0; i < health.size(); ++i) {
      const std::string text = fmt::format("{} {} {}", health[i].device, name_of(health[i].life), health[i].detail);
      // Counters that only grow are not printed again.
      if (text.substr(0, 40) == said[i].substr(0, 40)) continue;
      said[i] = text;
      fmt::print("DRIVE {}\n", text);
      std::fflush(stdout);
    }
    // A move takes 4 s at most. The drives report its end to the head; the test trusts the nodes' own output.
    if (well && now - well_since > std::chrono::seconds(6)) break;
    std::this_thread::sleep_for(driver->bounds().write_period);
  }
  driver->deactivate(now);
  return well ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGTERM, ask_to_stop);
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "nodes" && argc == 3) return nodes(argv[2]);
  if (what == "drive" && argc == 6) return drive(argv[2], std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5]));
  fmt::print(stderr, "can_axes nodes IF | drive IF PAN TILT SECONDS\n");
  return 2;
}
