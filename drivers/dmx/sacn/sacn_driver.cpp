#include "drivers/dmx/sacn/sacn_driver.h"

#include <fmt/format.h>

#include "drivers/dmx/dmx_patch.h"
#include "drivers/dmx/sacn/sacn_source.h"
#include "drivers/io/host_id.h"
#include "drivers/io/udp.h"
#include "drivers/life.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kSacnOptions[] = {
    {"destination", "text", "", "\"multicast\"", "\"multicast\", or an IPv4 address",
     "where packets go: each universe to its multicast group 239.255.x.y, or all to one receiver"},
    {"port", "whole number", "", "5568", "1 to 65535", "UDP port of the receivers"},
    {"interface", "text", "", "\"\"", "a name (eth0), or the interface's IPv4 address",
     "network interface that multicast leaves by; empty: the system chooses"},
    {"ttl", "whole number", "hops", "8", "1 to 255", "how many routers a multicast packet may pass"},
    {"priority", "whole number", "", "100", "0 to 200", "the source with the highest priority wins at the receiver"},
    {"source_name", "text", "", "\"\"", "at most 63 bytes of UTF-8",
     "what receivers show as the sender; empty: Luxrig and the rig's name"},
    {"cid", "text", "", "\"\"", "a UUID, 8-4-4-4-12 hexadecimal digits",
     "component identifier; empty: derived from host, rig and bus, the same after every restart"},
    {"continuous", "true or false", "", "true", "",
     "send every cycle; false: only changes, three repeats, then a keep-alive every 0.88 s"},
};

constexpr Duration kSacnWritePeriod = std::chrono::nanoseconds(22727273);  // 1/44 s
constexpr Duration kReopenSacnEvery = std::chrono::seconds(1);
// The network may answer as seldom as once a second (Linux limits its ICMP to that), so silence counts as recovery
// only after more than a second.
constexpr Duration kQuietBeforeSacnRecovery = std::chrono::milliseconds(1200);
constexpr int kErrorsPerCycle = 64;
constexpr int kGoodbyes = 3;  // clause 6.2.6

class SacnDriver final : public Driver, public LevelOutput, public Mover {
 public:
  SacnDriver(std::unique_ptr<DatagramChannel> channel, const Rig& rig, std::size_t bus,
             const std::optional<Redirect>& redirect)
      : channel_(std::move(channel)), bay_(rig, bus), life_(rig.buses[bus].name) {
    const Bus& entry = rig.buses[bus];
    rig_name_ = rig.name;
    port_ = static_cast<std::uint16_t>(integer_option(entry, kSacnOptions, "port"));
    unicast_ = parse_ipv4(string_option(entry, kSacnOptions, "destination"));
    if (redirect) {
      unicast_ = parse_ipv4(redirect->host).value_or(0x7F000001);
      port_ = static_cast<std::uint16_t>(redirect->port);
    }
    settings_.priority = static_cast<int>(integer_option(entry, kSacnOptions, "priority"));
    settings_.continuous = boolean_option(entry, kSacnOptions, "continuous");
    settings_.source_name = string_option(entry, kSacnOptions, "source_name");
    if (settings_.source_name.empty()) settings_.source_name = "Luxrig " + rig.name;
    cid_ = sacn::parse_cid(string_option(entry, kSacnOptions, "cid"));
  }
  ~SacnDriver() override { close(); }
  SacnDriver(const SacnDriver&) = delete;
  SacnDriver& operator=(const SacnDriver&) = delete;

  DriverBounds bounds() const override {
    DriverBounds bounds;
    // Sends never block; 0.1 ms a universe is ten times what a send costs.
    bounds.write = std::chrono::milliseconds(5) +
                   std::chrono::microseconds(100) * static_cast<std::int64_t>(bay_.universes().size());
    bounds.write_period = kSacnWritePeriod;
    bounds.fault_after = std::chrono::milliseconds(500);
    bounds.notices_loss = unicast_.has_value();
    return bounds;
  }

  Result<void> activate(Time now) override {
    if (life_.life() != Life::configured) return {};
    if (!source_) {
      settings_.cid = cid_.value_or(sacn::derive_cid(host_id(), rig_name_, life_.health().device));
      source_.emplace(settings_);
    }
    life_.active(now);
    last_error_.reset();
    open(now);
    return {};
  }

  void deactivate(Time now) override {
    if (life_.life() == Life::configured) return;
    close();
    life_.configured(now);
  }

  std::vector<Health> health(Time) const override { return {life_.health()}; }
  LevelOutput* level_output() override { return this; }
  Mover* mover() override { return bay_.has_heads() ? this : nullptr; }

  Result<void> move(Time, std::span<const AimCommand> commands) override {
    if (life_.life() == Life::configured) return tl::unexpected(inactive());
    return bay_.set_aims(commands);
  }

  Result<void> write(Time now, std::span<const LevelCommand> commands) override {
    if (life_.life() == Life::configured) return tl::unexpected(inactive());
    if (auto set = bay_.set_levels(commands); !set) return set;
    if (!channel_->is_open()) {
      if (now < reopen_at_) return tl::unexpected(life_.fault());
      open(now);
      if (!channel_->is_open()) return tl::unexpected(life_.fault());
    }
    collect_errors(now);
    for (const DmxUniverse& universe : bay_.universes()) {
      const auto packet = source_->due(now, universe.number, universe.slots);
      if (!packet) continue;
      ++packets_;
      if (auto sent = channel_->send(address_of(universe.number), *packet); !sent) {
        note_error(now, sent.error());
      } else {
        life_.count_sent();
        if (!last_error_ || *last_error_ != now) life_.mark_ok(now);
      }
    }
    if (life_.life() == Life::faulted && now - *last_error_ >= kQuietBeforeSacnRecovery) {
      life_.active(now);
      last_error_.reset();
    }
    if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
    return {};
  }

 private:
  Fault inactive() const { return {Cause::inactive, life_.health().device, "the driver is not active", {}}; }

  SocketAddress address_of(int universe) const {
    return {unicast_.value_or(sacn::multicast_group(static_cast<std::uint16_t>(universe))), port_};
  }

  void open(Time now) {
    reopen_at_ = now + kReopenSacnEvery;
    if (auto opened = channel_->open(); !opened) note_error(now, opened.error());
  }

  void close() {
    if (channel_->is_open()) {
      for (int i = 0; i < kGoodbyes; ++i) {
        for (const DmxUniverse& universe : bay_.universes()) {
          const auto packet = source_->goodbye(universe.number);
          // Nobody is left to be told when a goodbye cannot be sent.
          if (packet && channel_->send(address_of(universe.number), *packet)) life_.count_sent();
        }
      }
      channel_->close();
    }
    if (source_) source_->rest();
  }

  void collect_errors(Time now) {
    for (int i = 0; i < kErrorsPerCycle; ++i) {
      const auto error = channel_->take_error();
      if (!error) return;
      note_error(now, *error);
    }
  }

  void note_error(Time now, const Fault& fault) {
    last_error_ = now;
    Fault with_figures = fault;
    with_figures.detail += fmt::format(" ({} errors, {} packets)", life_.health().errors + 1, packets_);
    life_.faulted(now, with_figures);
  }

  std::unique_ptr<DatagramChannel> channel_;
  DmxPatchbay bay_;
  LifeRecord life_;
  std::string rig_name_;
  std::optional<std::uint32_t> unicast_;
  std::uint16_t port_ = 0;
  std::optional<sacn::Cid> cid_;
  sacn::SourceSettings settings_;
  std::optional<sacn::Source> source_;
  std::optional<Time> last_error_;
  Time reopen_at_{};
  std::uint64_t packets_ = 0;
};

}  // namespace

std::span<const OptionDoc> sacn_options() { return kSacnOptions; }

std::vector<Problem> check_sacn(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kSacnOptions);
  std::vector<Problem> patch = check_dmx_patch(rig, bus, sacn::kLowestUniverse, sacn::kHighestUniverse);
  if (problems.empty()) {
    const auto report = [&](std::string_view key, std::string what, std::string mend) {
      problems.push_back(problem_at(rig, entry, key, std::move(what), std::move(mend)));
    };
    const std::string destination = string_option(entry, kSacnOptions, "destination");
    const auto address = parse_ipv4(destination);
    if (destination != "multicast" && (!address || *address == 0 || is_multicast(*address) || *address == 0xFFFFFFFF)) {
      report("destination",
             fmt::format("destination = \"{}\" is neither \"multicast\" nor a receiver's IPv4 address", destination),
             "write \"multicast\", or an address such as \"192.168.1.20\"");
    }
    const std::string interface = string_option(entry, kSacnOptions, "interface");
    if (interface.size() > 15 || interface.find_first_of(" /") != std::string::npos) {
      report("interface", fmt::format("interface = \"{}\" cannot be the name of a network interface", interface),
             "write a name as `ip link` lists it, such as \"eth0\", or its IPv4 address");
    }
    const std::string cid = string_option(entry, kSacnOptions, "cid");
    if (!cid.empty() && !sacn::parse_cid(cid)) {
      report("cid", fmt::format("cid = \"{}\" is not a UUID", cid),
             "write one as `uuidgen` prints it, or leave the option out");
    }
    const std::string source_name = string_option(entry, kSacnOptions, "source_name");
    if (source_name.size() >= sacn::kSourceNameBytes) {
      report("source_name", fmt::format("source_name has {} bytes", source_name.size()), "keep it to 63 bytes");
    }
  }
  problems.insert(problems.end(), patch.begin(), patch.end());
  return problems;
}

std::unique_ptr<Driver> make_sacn_over(std::unique_ptr<DatagramChannel> channel, const Rig& rig, std::size_t bus,
                                       const std::optional<Redirect>& redirect) {
  return std::make_unique<SacnDriver>(std::move(channel), rig, bus, redirect);
}

std::unique_ptr<Driver> make_sacn(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  UdpSettings settings;
  settings.multicast_ttl = static_cast<int>(integer_option(rig.buses[bus], kSacnOptions, "ttl"));
  // Towards a stand-in on loopback the interface named for the real network does not matter, and may not exist.
  if (!redirect) settings.multicast_interface = string_option(rig.buses[bus], kSacnOptions, "interface");
  return make_sacn_over(make_udp(std::move(settings)), rig, bus, redirect);
}

}  // namespace luxrig
