// replay: a recording sent again as a lighting desk; or what is in it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <memory>

#include "core/rig/rig_file.h"
#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/io/udp.h"
#include "drivers/options.h"
#include "drivers/registry.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/process/clock.h"
#include "tools/recording/desk_player.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

struct ReplayArguments {
  std::filesystem::path file, rig;
  std::string to, source;
  double speed = 1;
  bool loop = false, info = false;
};

/// "10.0.0.7" or "10.0.0.7:6454"; port 0: none is written.
std::optional<SocketAddress> receiver_at(const std::string& text) {
  const auto colon = text.find(':');
  const auto ipv4 = parse_ipv4(text.substr(0, colon));
  if (!ipv4 || *ipv4 == 0) return std::nullopt;
  SocketAddress address{*ipv4, 0};
  if (colon == std::string::npos) return address;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, address.port);
  if (parsed.ec != std::errc() || parsed.ptr != end || address.port == 0) return std::nullopt;
  return address;
}

std::string cid_text(const sacn::Cid& cid) {
  std::string text;
  for (std::size_t i = 0; i < cid.size(); ++i)
    text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", cid[i]);
  return text;
}

/// "1-3 7".
std::string ranges_of(const std::set<int>& numbers) {
  std::string text;
  for (auto at = numbers.begin(); at != numbers.end();) {
    const int first = *at;
    int last = first;
    for (++at; at != numbers.end() && *at == last + 1; ++at) last = *at;
    text += fmt::format("{}{}", text.empty() ? "" : " ", first);
    if (last > first) text += fmt::format("-{}", last);
  }
  return text;
}

void print_info(const recording::Recording& recorded, const Rig* rig) {
  fmt::print("{} packets, {:.1f} s\n", recorded.packets, to_seconds(recorded.length));
  const std::vector<bool> own =
      rig != nullptr ? recording::own_sources(recorded, *rig) : std::vector<bool>(recorded.sources.size(), false);
  if (!recorded.sources.empty()) {
    Table table({"DMX by", "source", "from", "universes", "packets", ""});
    for (std::size_t s = 0; s < recorded.sources.size(); ++s) {
      const recording::Source& source = recorded.sources[s];
      const bool of_ola = source.protocol == recording::Protocol::ola;
      table.row({std::string(name_of(source.protocol)), source.name, of_ola ? "" : text_of(source.address),
                 ranges_of(source.universes), fmt::format("{}", source.packets), own[s] ? "Luxrig itself" : ""});
    }
    fmt::print("{}", table.text());
  }
  if (!recorded.modbus.empty() || recorded.modbus_refused + recorded.modbus_unanswered > 0) {
    const auto reads = std::count_if(recorded.modbus.begin(), recorded.modbus.end(),
                                     [](const auto& one) { return modbus::reads(one.request.function); });
    fmt::print("Modbus TCP: {} reads and {} writes answered, {} refused, {} not answered\n", reads,
               recorded.modbus.size() - static_cast<std::size_t>(reads), recorded.modbus_refused,
               recorded.modbus_unanswered);
  }
  if (rig != nullptr) {
    const auto readings = recording::meter_readings(recorded, *rig);
    for (std::size_t m = 0; m < readings.size(); ++m) {
      if (readings[m].empty()) continue;
      const auto [least, most] = std::minmax_element(readings[m].begin(), readings[m].end(),
                                                     [](const auto& a, const auto& b) { return a.lux < b.lux; });
      fmt::print("luxmeter {}: {} readings, {:.1f} to {:.1f} lx\n", rig->luxmeters[m].name, readings[m].size(),
                 least->lux, most->lux);
    }
  }
  std::size_t frames = 0;
  for (const auto& [id, count] : recorded.can_frames) frames += count;
  if (frames > 0) fmt::print("CAN: {} frames of {} identifiers\n", frames, recorded.can_frames.size());
  for (const auto& [node, drive] : recorded.drives) {
    std::string axis = fmt::format("node {}: {} to {} counts", node, drive.least, drive.greatest);
    if (rig != nullptr)
      for (const Fixture& fixture : rig->fixtures) {
        if (!fixture.axes) continue;
        for (const auto& [name, patch] : {std::pair("pan", fixture.axes->pan), std::pair("tilt", fixture.axes->tilt)})
          if (patch.node == node)
            axis += fmt::format(" ({} {}: {:.1f} to {:.1f}°)", fixture.name, name,
                                deg_from_rad(patch.joint_rad_at(drive.least)),
                                deg_from_rad(patch.joint_rad_at(drive.greatest)));
      }
    fmt::print("  drive {}, {} reports\n", axis, drive.reports);
  }
  if (recorded.sources.empty() && recorded.modbus.empty() && frames == 0)
    fmt::print("no sACN, Art-Net, Modbus TCP or CAN in it\n");
}

/// Where the rig's buses listen to a desk, or the receiver of --to.
std::vector<recording::Receiver> receivers_of(const Rig* rig, const std::optional<SocketAddress>& to) {
  std::vector<recording::Receiver> all;
  if (rig == nullptr) {
    for (const auto& [protocol, port] :
         {std::pair(recording::Protocol::sacn, sacn::kPort), std::pair(recording::Protocol::artnet, artnet::kPort)})
      all.push_back({protocol, to->ipv4, to->port != 0 ? to->port : port, std::nullopt});
    return all;
  }
  for (const recording::DeskBus& bus : recording::desk_buses(*rig)) {
    recording::Receiver receiver{bus.protocol, std::nullopt, bus.desk.port, bus.universes};
    const Bus& entry = rig->buses[bus.bus];
    if (bus.protocol == recording::Protocol::artnet)
      receiver.ipv4 = parse_ipv4(string_option(entry, find_driver(entry.driver)->options, "broadcast"));
    if (to) {
      receiver.ipv4 = to->ipv4;
      if (to->port != 0) receiver.port = to->port;
    }
    all.push_back(std::move(receiver));
  }
  return all;
}

int refuse_replay(const std::string& text) {
  fmt::print(stderr, "luxrig: {}\n", text);
  return kExitBadInput;
}

int send(const ReplayArguments& arguments, recording::DeskPlayer player) {
  UdpSettings settings;
  settings.broadcast = true;
  const auto channel = make_udp(settings);
  if (const auto opened = channel->open(); !opened) return report(opened.error());
  const std::stop_token stop = stop_on_signals();
  const Time begin = now();
  std::size_t sent = 0, failed = 0;
  std::string why;
  const auto send_all = [&](const std::vector<recording::DeskPlayer::Outgoing>& all) {
    for (const auto& one : all) {
      const auto done = channel->send(one.to, one.bytes);
      ++(done ? sent : failed);
      if (!done) why = done.error().detail;
    }
  };
  fmt::print("sending {} packets{}\n", player.packets(), player.repeats() ? ", again and again, until Ctrl-C" : "");
  std::fflush(stdout);
  // Awake often, so that Ctrl-C ends it at once.
  constexpr Duration kLongestSleep = std::chrono::milliseconds(50);
  for (auto due = player.next(); due && !stop.stop_requested(); due = player.next()) {
    const Time wake = std::min(begin + *due, now() + kLongestSleep);
    sleep_until(wake);
    send_all(player.due(now() - begin));
  }
  send_all(player.goodbyes());
  fmt::print("sent {} packets in {:.1f} s\n", sent, to_seconds(now() - begin));
  if (failed == 0) return kExitOk;
  fmt::print(stderr, "luxrig: {} packets of {} were not sent: {}\n", failed, arguments.file.string(), why);
  return kExitFailed;
}

int run_replay(const ReplayArguments& arguments) {
  std::optional<Rig> rig;
  if (!arguments.rig.empty()) {
    auto loaded = load_rig(arguments.rig);
    if (!loaded) return report(loaded.error());
    rig = std::move(*loaded);
    if (const auto problems = check_buses(*rig); !problems.empty()) return report(problems);
  }
  const auto to = arguments.to.empty() ? std::nullopt : receiver_at(arguments.to);
  if (!arguments.to.empty() && !to)
    return refuse_replay(
        fmt::format("--to {} is no IPv4 address to send to: write 2.0.0.10, or 2.0.0.10:5568", arguments.to));
  const auto recorded =
      recording::read_recording(arguments.file, rig ? recording::modbus_ports(*rig) : std::set<std::uint16_t>{});
  if (!recorded) return report(recorded.error());
  if (arguments.info) {
    print_info(*recorded, rig ? &*rig : nullptr);
    return kExitOk;
  }
  if (!rig && !to) return refuse_replay("where to? name a rig whose bus has `input`, or an address with --to");
  recording::PlayerSettings settings;
  settings.receivers = receivers_of(rig ? &*rig : nullptr, to);
  if (settings.receivers.empty())
    return refuse_replay(
        fmt::format("no bus of {} listens to a desk: give it `input` in the rig file, or leave the "
                    "rig out and say --to",
                    arguments.rig.string()));
  const std::vector<bool> own =
      rig ? recording::own_sources(*recorded, *rig) : std::vector<bool>(recorded->sources.size(), false);
  for (std::size_t s = 0; s < recorded->sources.size(); ++s) {
    const recording::Source& source = recorded->sources[s];
    const bool named = arguments.source == source.name || arguments.source == cid_text(source.cid) ||
                       arguments.source == text_of(source.address.ipv4);
    settings.sources.push_back(arguments.source.empty() ? !own[s] : named);
  }
  settings.speed = arguments.speed;
  settings.repeats = arguments.loop;
  recording::DeskPlayer player(*recorded, std::move(settings));
  if (player.packets() == 0)
    return refuse_replay(
        fmt::format("nothing in {} is for this receiver: --info says what is in it", arguments.file.string()));
  return send(arguments, std::move(player));
}

Action declare_replay(CLI::App& command) {
  const auto replay = std::make_shared<ReplayArguments>();
  command.add_option("FILE", replay->file, "a pcap or pcapng file, or a show by OLA's ola_recorder")
      ->required()
      ->check(offers_files());
  add_rig_option(command, replay->rig)->required(false);
  command.add_flag("--info", replay->info, "only say what is in it; with RIG also what its meters showed");
  command.add_option("--to", replay->to, "receiver, HOST or HOST:PORT (else where the rig listens to a desk)");
  command.add_option("--source", replay->source, "only this source: its name, CID or address");
  command.add_option("--speed", replay->speed, "so many times as fast")->check(CLI::Range(0.01, 100.0));
  command.add_flag("--loop", replay->loop, "again and again, until Ctrl-C");
  command.footer(
      "Sends the recorded sACN and Art-Net as a desk does, all sources but Luxrig\n"
      "itself. A scenario replays it on a simulated rig: do = \"replay\".");
  return [replay] { return run_replay(*replay); };
}

}  // namespace

const Command kReplayCommand{"replay", command_group::kDevices, "a recording sent again as a desk, or what is in it",
                             declare_replay};

}  // namespace luxrig
