// record: traffic of a rig to a pcap file, and a scenario that replays it.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "core/rig/rig_file.h"
#include "drivers/registry.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/process/clock.h"
#include "tools/process/files.h"
#include "tools/recording/capture.h"
#include "tools/recording/recording.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

struct RecordArguments {
  std::filesystem::path rig, file, scenario;
  std::optional<double> seconds;
  std::string interface = "any";
};

constexpr auto kStep = std::chrono::milliseconds(20);

void tell_how_else(const RecordArguments& arguments, const std::string& filter) {
  fmt::print(stderr,
             "luxrig: this user may not capture packets: run it with sudo, or once\n"
             "  sudo setcap cap_net_raw+ep {}\n"
             "or record with another program, and replay its file:\n"
             "  sudo tshark -i {} -w {} -f '{}'\n",
             std::filesystem::read_symlink("/proc/self/exe").string(), arguments.interface, arguments.file.string(),
             filter);
}

std::string counts_line(double seconds, const recording::Capture::Counts& now,
                        const recording::Capture::Counts& before) {
  std::string line = fmt::format("{:6.0f} s", seconds);
  const auto add = [&](std::string_view what, std::size_t count, std::size_t so_far) {
    if (so_far > 0) line += fmt::format("  {} {}/s", what, count);
  };
  add("sACN", now.sacn - before.sacn, now.sacn);
  add("Art-Net", now.artnet - before.artnet, now.artnet);
  add("Modbus", now.modbus - before.modbus, now.modbus);
  add("CAN", now.can - before.can, now.can);
  add("other", now.other - before.other, now.other);
  if (now == recording::Capture::Counts{}) line += "  nothing yet";
  if (now.dropped > 0) line += fmt::format("  LOST {}", now.dropped);
  return line;
}

/// A scenario of the recording's length that replays it. Its expectations are for a person to write.
int write_scenario(const RecordArguments& arguments, const Rig& rig) {
  const auto recorded = recording::read_recording(arguments.file, {});
  if (!recorded) return report(recorded.error());
  std::error_code error;
  const auto folder = std::filesystem::absolute(arguments.scenario, error).parent_path();
  auto file = std::filesystem::relative(std::filesystem::absolute(arguments.file, error), folder, error);
  if (error || file.empty()) file = std::filesystem::absolute(arguments.file, error);
  std::string quoted;
  for (const char letter : file.string())
    quoted += letter == '"' || letter == '\\' ? std::string{'\\', letter} : std::string{letter};
  const std::string text = fmt::format(
      "[scenario]\nname = \"as recorded\"\nlength_s = {}\n\n[[event]]\nat_s = 0\ndo = \"replay\"\nrecording = "
      "\"{}\"\n\n"
      "# What should have been: for example\n# [[expect]]\n# always = \"lux {} <= 50\"\n",
      std::max(10.0, std::ceil(to_seconds(recorded->length)) + 1), quoted,
      rig.points.empty() ? std::string("POINT") : rig.points.front().name);
  if (const auto written = write_file(arguments.scenario, text); !written) return report(written.error());
  fmt::print("{}: say in it what you expect, then: luxrig test {} {}\n", arguments.scenario.string(),
             arguments.rig.string(), arguments.scenario.string());
  return kExitOk;
}

int run_record(const RecordArguments& arguments) {
  const auto rig = load_rig(arguments.rig);
  if (!rig) return report(rig.error());
  if (const auto problems = check_buses(*rig); !problems.empty()) return report(problems);
  const auto filter = recording::filter_for(*rig, arguments.interface == "any");
  for (const std::string& bus : filter.unseen) fmt::print(stderr, "luxrig: bus {}\n", bus);
  if (filter.text.empty()) {
    fmt::print(stderr, "luxrig: no bus of this rig can be captured: sACN, Art-Net, Modbus TCP and CAN can\n");
    return kExitBadInput;
  }
  const std::stop_token stop = stop_on_signals();
  auto capture = recording::Capture::begin(arguments.interface, filter.text, arguments.file);
  if (!capture) {
    if (capture.error().cause != Cause::refused) return report(capture.error());
    tell_how_else(arguments, filter.text);
    return kExitFailed;
  }
  fmt::print("recording {} on {} to {}, until Ctrl-C\n", filter.text, arguments.interface, arguments.file.string());
  std::fflush(stdout);
  const Time begin = now();
  Time told = begin;
  recording::Capture::Counts before;
  while (!stop.stop_requested() && (!arguments.seconds || now() - begin < from_seconds(*arguments.seconds))) {
    if (const auto stepped = capture->step(); !stepped) return report(stepped.error());
    if (now() - told >= std::chrono::seconds(1)) {
      told += std::chrono::seconds(1);
      if (const auto flushed = capture->flush(); !flushed) return report(flushed.error());
      fmt::print("{}\n", counts_line(to_seconds(told - begin), capture->counts(), before));
      std::fflush(stdout);
      before = capture->counts();
    }
    std::this_thread::sleep_for(kStep);
  }
  if (const auto stepped = capture->step(); !stepped) return report(stepped.error());
  if (const auto flushed = capture->flush(); !flushed) return report(flushed.error());
  const recording::Capture::Counts& all = capture->counts();
  fmt::print("{}: {} packets: sACN {}, Art-Net {}, Modbus {}, CAN {}, other {}\n", arguments.file.string(),
             all.sacn + all.artnet + all.modbus + all.can + all.other, all.sacn, all.artnet, all.modbus, all.can,
             all.other);
  if (all.dropped > 0)
    fmt::print(stderr, "luxrig: {} packets are missing, as this computer was too slow\n", all.dropped);
  return arguments.scenario.empty() ? kExitOk : write_scenario(arguments, *rig);
}

Action declare_record(CLI::App& command) {
  const auto record = std::make_shared<RecordArguments>();
  add_rig_option(command, record->rig);
  command.add_option("FILE", record->file, "pcap file to write, which Wireshark reads too")
      ->required()
      ->check(offers_files());
  command.add_option("--seconds", record->seconds, "how long (else until Ctrl-C)")->check(CLI::Range(0.1, 604800.0));
  command.add_option("--interface", record->interface, "network interface; any: all of them, and CAN");
  command.add_option("--scenario", record->scenario, "write a scenario here that replays the recording")
      ->check(offers_files());
  command.footer(
      "Captures what the rig's buses carry: sACN, Art-Net, Modbus TCP, CAN. `luxrig\n"
      "replay` sends it again, and `luxrig test` replays it in a tested show.");
  return [record] { return run_record(*record); };
}

}  // namespace

const Command kRecordCommand{"record", command_group::kDevices, "traffic of a real rig to a file", declare_record};

}  // namespace luxrig
