/// One USB driver of the registry on a real kernel, controlled by words of a script.
///   usb_driver NAME WORD...
///       set=0…255     slot 1, then 44 cycles
///       wait=MS       cycles
///       life=active   or life=faulted: cycles until then, at most 15 s
///       off, on       deactivate, activate
///       print=TEXT
/// Exits 0 if every life= was reached. Prints its observations to stdout.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "drivers/registry.h"

int main(int argc, char** argv) {
  using namespace luxrig;
  using std::chrono::milliseconds;
  setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc < 2) return 2;
  const DriverEntry* entry = find_driver(argv[1]);
  if (entry == nullptr) return 2;
  Rig rig;
  rig.file = "guest";
  rig.name = "guest";
  Bus bus;
  bus.name = "bus";
  bus.driver = argv[1];
  rig.buses.push_back(bus);
  Fixture fixture;
  fixture.name = "lamp";
  fixture.patch = DmxPatch{1, 1, {DmxSlot{}}};
  rig.fixtures.push_back(fixture);
  const auto driver = entry->make(rig, 0, std::nullopt);

  const auto now = [] {
    return Time{} + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch());
  };
  double drive = 0;
  Duration longest{};
  const auto cycle = [&] {
    const Time start = now();
    const LevelCommand command{0, drive};
    (void)driver->level_output()->write(start, {&command, 1});
    longest = std::max(longest, now() - start);
    std::this_thread::sleep_for(milliseconds(23));
    return driver->health(now()).at(0);
  };
  (void)driver->activate(now());
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string value = word.substr(std::min(word.size(), word.find('=') + 1));
    if (word.starts_with("set=")) {
      drive = std::atoi(value.c_str()) / 255.0;
      for (int n = 0; n < 44; ++n) (void)cycle();
    } else if (word.starts_with("wait=")) {
      for (const Time end = now() + milliseconds(std::atoi(value.c_str())); now() < end;) (void)cycle();
    } else if (word.starts_with("life=")) {
      Health health;
      for (const Time end = now() + milliseconds(15000); now() < end && name_of(health.life) != value;)
        health = cycle();
      std::printf("driver: %s %s (%s)\n", argv[1], name_of(health.life), health.detail.c_str());
      if (name_of(health.life) != value) return 1;
    } else if (word == "off") {
      driver->deactivate(now());
    } else if (word == "on") {
      (void)driver->activate(now());
    } else if (word.starts_with("print=")) {
      std::printf("driver: %s\n", value.c_str());
    } else {
      return 2;
    }
  }
  const Health health = driver->health(now()).at(0);
  std::printf("driver: %s sent %llu, received %llu, errors %llu, longest write %.1f ms\n", argv[1],
              static_cast<unsigned long long>(health.sent), static_cast<unsigned long long>(health.received),
              static_cast<unsigned long long>(health.errors), to_seconds(longest) * 1e3);
  return 0;
}
