#include "tools/luxrigd/daemon.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "core/tasks/rig_version.h"
#include "drivers/registry.h"
#include "tools/command_line/installed.h"
#include "tools/luxrigd/api/preview_json.h"
#include "tools/luxrigd/api/scene_file.h"
#include "tools/luxrigd/api/status_json.h"
#include "tools/luxrigd/painted_goals.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/clock.h"

namespace luxrig {

struct PublishedStatus {
  std::shared_ptr<const Session> session;
  ShowStatus show;
  std::vector<Health> devices;
  OutputFigures output;
  Time at{};
};

namespace {

constexpr Duration kPublishPeriod = std::chrono::milliseconds(100);
constexpr Duration kSafeLookEvery = std::chrono::seconds(1), kGuardianLook = std::chrono::seconds(1);
constexpr int kMaxDoublings = 6;
constexpr auto kCommandBound = std::chrono::seconds(2);
constexpr Duration kDarkWithin = std::chrono::seconds(1);
/// A daemon just killed, or the guardian of one that ended in order, may hold its claims for a moment.
constexpr Duration kClaimWait = std::chrono::seconds(2);

std::filesystem::path web_folder() { return shared_folder() / "web"; }

}  // namespace

Daemon::Daemon(std::shared_ptr<const Session> session, const KeptLight& light, DaemonOptions options)
    : options_(std::move(options)),
      controller_(session->rig, light.model, light.joints),
      journal_(options_.state_folder),
      change_log_(options_.state_folder),
      session_(std::move(session)),
      version_(version_of(session_->rig, session_->scene)),
      jobs_(options_.state_folder ? std::optional(*options_.state_folder / "plans") : std::nullopt) {}

Daemon::~Daemon() { stop(); }

Result<int> Daemon::start() {
  started_ = now();
  if (options_.state_folder) {
    std::error_code error;
    const auto folder = std::filesystem::weakly_canonical(*options_.state_folder, error);
    if (auto claimed = folder_claim_.take("state folder " + folder.string(), kClaimWait); !claimed)
      return refusal(fmt::format("{}: one Luxrig at a time; end that, or give --state another folder",
                                 claimed.error().detail));
  }
  const bool stepped = static_cast<bool>(options_.stepped_driver);
  // The page's port first: if it is taken, nothing else has been opened.
  Result<int> port = 0;
  if (!stepped) {
    http_ = std::make_unique<HttpApi>(handlers(), web_folder());
    DaemonSpec where = session_->rig.daemon;
    where.http_port = options_.http_port;
    port = http_->start(where);
    if (!port) return port;
    lock_memory();
  }
  if (options_.guarded && options_.state_folder) {
    auto memory = LastLookMemory::create(session_->rig.fixtures.size());
    if (!memory) return tl::unexpected(memory.error());
    guarded_.emplace(std::move(*memory));
  }
  // Drivers and buses keep this rig even after a reload has exchanged it for one with the same outputs.
  first_session_ = session_;
  const Rig& rig = session_->rig;
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    auto driver = stepped ? options_.stepped_driver(rig, b) : make_driver(rig, b);
    const std::size_t first_desk = desks_;
    if (const LevelInput* input = driver->level_input()) {
      for (const DeskPart& part : input->parts()) {
        controller_.add_desk(input->rules(), part);
        ++desks_;
      }
    }
    buses_.push_back(std::make_unique<BusThread>(rig, b, std::move(driver), programs_, first_desk,
                                                 orders()));
  }
  if (options_.guarded && options_.state_folder) {
    // A guardian left by an earlier daemon has the light until ours takes it, and hands over its last output.
    if (const auto light = send_guardian_away(*options_.state_folder, rig.fixtures.size())) {
      controller_.go_on_from(now(), *light);
      send_program();
    }
  }
  if (stepped) return port;
  controller_.solve_beside([](std::function<void()> solve) {
    // The task owns everything it uses, so shutdown need not wait for it.
    try {
      std::thread([solve] {
        make_background();
        solve();
      }).detach();
    } catch (const std::system_error&) {
      solve();  // no thread to be had: solve here, late
    }
  });
  if (auto claimed = claim_outputs(); !claimed) return tl::unexpected(claimed.error());
  if (guarded_) start_guardian(now());
  for (const auto& bus : buses_) bus->start();
  if (std::any_of(buses_.begin(), buses_.end(), [](const auto& bus) { return bus->contact().has_value(); }))
    contacts_ = std::jthread([this](const std::stop_token& stop) { watch_contacts(stop); });
  rig_file_watch_ = std::make_shared<RigFileWatch>(files_of(rig));
  draw_room_beside();
  return port;
}

OutputOrders Daemon::orders() {
  return {&blackout_, guarded_ ? &*guarded_ : nullptr, [this] {
            (void)blackout_.order(true);
            for (const auto& bus : buses_) bus->wake();
            contact_pressed_.release();
          }};
}

void Daemon::watch_contacts(const std::stop_token& stop) {
  while (true) {
    contact_pressed_.acquire();
    if (stop.stop_requested()) return;
    (void)blackout(true);
  }
}

std::unique_ptr<Driver> Daemon::make_driver(const Rig& rig, std::size_t bus) const {
  const auto it = options_.redirects.find(rig.buses[bus].name);
  return find_driver(rig.buses[bus].driver)
      ->make(rig, bus, it != options_.redirects.end() ? std::optional(it->second) : std::nullopt);
}

Result<void> Daemon::claim_outputs() {
  for (const std::string& output : outputs_of(session_->rig, options_.redirects)) {
    const auto claimed = output_claims_.take(output, kClaimWait);
    if (claimed) continue;
    if (claimed.error().cause == Cause::refused)
      return refusal(claimed.error().detail + ": two would fight for the light; end that first");
    return claimed;
  }
  return {};
}

/// The picture is drawn beside the start, so that the light need not wait for it. Normal priority: it takes a second,
/// and at low priority a busy computer might never get to it.
void Daemon::draw_room_beside() {
  drawing_ = std::jthread([this, session = session_] {
    RoomView room = draw_room(*session);
    const std::lock_guard lock(mutex_);
    if (session == session_) room_ = std::move(room);  // else a reload has drawn its own
  });
}

void Daemon::start_guardian(Time at) {
  GuardianSettings settings;
  settings.rig_file = session_->rig.file;
  settings.fixtures = session_->rig.fixtures.size();
  settings.redirects = options_.redirects;
  settings.state_folder = *options_.state_folder;
  settings.claims = output_claims_.descriptors();
  guardian_.reset();
  guardian_seen_ = at;
  // It would load another rig than the one in force.
  if (rig_file_watch_ && !rig_file_watch_->changed().empty()) {
    unguarded_ = "the rig file has changed since it was read: luxrig reload";
    return;
  }
  auto started = Guardian::start(std::move(settings), *guarded_, at);
  unguarded_ = started ? "" : started.error().detail;
  if (started) guardian_.emplace(std::move(*started));
}

void Daemon::look_after_guardian(Time at) {
  guarded_->beat(LastLookMemory::Beat::control);
  if (guarded_->guardian_has_the_light()) {
    // We hung, and the guardian took over: the light goes on from its output.
    const auto light = send_guardian_away(*options_.state_folder, session_->rig.fixtures.size());
    if (guardian_) guardian_->leave();
    if (light) {
      controller_.take_back(at, light->look.levels);
      send_program();
    }
    guarded_->take_the_light_back();
    stood_still_at_ = at;
    return start_guardian(at);
  }
  // A guardian that dies right after its start, because its rig file has changed for example, is retried less and less
  // often.
  if (at - guardian_seen_ < kGuardianLook * (1 << guardian_deaths_)) return;
  guardian_seen_ = at;
  if (guardian_ && guardian_->alive(at)) {
    if (guardian_->looks()) {
      unguarded_since_.reset();
      guardian_deaths_ = 0;  // it has survived the whole wait
    }
    return;
  }
  if (!unguarded_since_) unguarded_since_ = at;
  guardian_deaths_ = std::min(guardian_deaths_ + 1, kMaxDoublings);
  start_guardian(at);
}

/// Stores the light that the guardian sends if this process dies now.
void Daemon::tell_guardian(Time at) {
  if (!guarded_) return;
  const Rig& rig = session_->rig;
  const OutputProgram& program = controller_.program();
  const std::size_t count = rig.fixtures.size();
  last_look_.look.levels.resize(count);
  last_look_.look.joints.resize(count);
  program.levels_at(at, last_look_.look.levels);
  program.joints_at(at, last_look_.look.joints);
  // The safe look changes only slowly, with the calibration from meters.
  if (safe_levels_.empty() || at - safe_look_at_ > kSafeLookEvery) {
    safe_levels_ = controller_.safe_look(at);
    safe_look_at_ = at;
  }
  last_look_.safe_levels = safe_levels_;
  // Heads that could light a keep-out zone stay dark while no control loop watches them.
  for (const HeadDim& dim : program.dims) {
    if (dim.to == 0) last_look_.look.levels[dim.fixture] = last_look_.safe_levels[dim.fixture] = 0;
  }
  // So do heads that may look elsewhere than the safe look has them, where points have limits.
  for (std::size_t f = 0; f < program.turned.size(); ++f)
    if (program.turned[f] != 0) last_look_.safe_levels[f] = 0;
  if (program.blackout) std::fill(last_look_.safe_levels.begin(), last_look_.safe_levels.end(), 0.0);
  last_look_.hold_s = program.blackout ? 0 : rig.safe.hold_s;
  last_look_.fade_s = rig.safe.fade_s;
  last_look_.silent.assign(count, 0);
  for (const DeskBlend& desk : program.desks) {
    if (!desk.silent) continue;
    for (const std::size_t f : desk.fixtures) last_look_.silent[f] = 1;
  }
  guarded_->put(last_look_, program.revision != 0);
  look_after_guardian(at);
}
std::future<void> Daemon::queue(std::function<void(Time)> run) {
  const std::lock_guard lock(mutex_);
  commands_.push_back({std::move(run), {}});
  return commands_.back().done.get_future();
}

/// Runs `run` between two ticks and waits for it, for two seconds at most.
void Daemon::on_control_thread(std::function<void(Time)> run) {
  if (std::this_thread::get_id() == control_thread_) return run(now());
  queue(std::move(run)).wait_for(kCommandBound);
}

Result<void> Daemon::blackout(bool on) {
  for (const auto& bus : buses_) {
    if (on || bus->contact() != Contact::pressed) continue;
    return refusal(fmt::format("the blackout contact of bus \"{}\" asks for it: release that first",
                               first_session_->rig.buses[bus->bus()].name));
  }
  const std::uint64_t order = blackout_.order(on);
  for (const auto& bus : buses_) bus->wake();
  queue([this](Time at) {
    const std::uint64_t newest = blackout_.number();
    controller_.blackout(at, blackout_.wanted());
    send_program();
    blackout_.lift(newest);
  });
  // The light first, then the disk. Of several concurrent orders the last one counts.
  std::string not_dark;
  if (on && std::this_thread::get_id() != control_thread_) not_dark = wait_until_dark(order);
  const auto saved = journal_.keep([this](JournalState& state) { state.blackout = blackout_.wanted(); });
  if (saved && not_dark.empty()) return {};
  std::string why = "it holds, but ";
  if (!not_dark.empty()) why += "lamps may be lit: " + not_dark;
  if (!saved) why += (not_dark.empty() ? "" : "; and it ") + ("would be forgotten: " + saved.error().detail);
  return tl::unexpected(Fault{saved ? Cause::timeout : saved.error().cause, {}, why, {}});
}

std::string Daemon::wait_until_dark(std::uint64_t order) const {
  const Time until = now() + kDarkWithin;
  std::string late;
  do {
    late.clear();
    for (const auto& bus : buses_) {
      if (!bus->lights() || bus->dark_order() >= order) continue;
      late += (late.empty() ? "" : ", ") + ("bus \"" + first_session_->rig.buses[bus->bus()].name + "\" has not taken it yet");
    }
    if (late.empty()) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (now() < until);
  return late;
}

bool Daemon::park() { return controller_.park(now(), {}).has_value(); }

std::string Daemon::universes_json() {
  const auto universes = ask_control_thread<nlohmann::json>([this](Time) {
    nlohmann::json all = nlohmann::json::array();
    for (const auto& bus : buses_) {
      for (const CarriedUniverse& one : bus->carried()) {
        all.push_back({{"bus", session_->rig.buses[bus->bus()].name},
                       {"universe", one.number},
                       {"silent", one.silent},
                       {"slots", one.slots}});
      }
    }
    return all;
  });
  return universes.value_or(nlohmann::json::array()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::shared_ptr<const PublishedStatus> Daemon::published() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

StatusInput Daemon::input_of(const PublishedStatus& status) {
  return {status.session->rig, status.show,          status.devices,
          status.output,       options_.simulated,   started_,
          status.at,           options_.sim_control, questions_.present(now())};
}

HttpHandlers Daemon::handlers() {
  HttpHandlers handlers;
  handlers.settings = [this] { return settings_of(journal_.state()); };
  handlers.record = [this](nlohmann::json change) { change_log_.add(std::move(change)); };
  handlers.change_log = [this] { return change_log_.newest(); };
  handlers.status = [this]() -> std::string {
    const auto last = published();
    return last ? status_json(input_of(*last)) : "{}";
  };
  handlers.changes = [this](const std::string& version) -> std::string {
    const auto last = published();
    if (!last) return "{}";
    std::shared_ptr<const KeptAnswer> rig;
    {
      const std::lock_guard lock(mutex_);
      if (last->session == session_) rig = room_.rig;
    }
    return changes_.since(version, input_of(*last), last->session, rig ? std::string_view(rig->etag) : "");
  };
  handlers.rig = [this] {
    const std::lock_guard lock(mutex_);
    return room_.rig;
  };
  handlers.universes = [this] { return universes_json(); };
  handlers.room_json = [this] {
    const std::lock_guard lock(mutex_);
    return room_.json;
  };
  handlers.room_png = [this] {
    const std::lock_guard lock(mutex_);
    return room_.png;
  };
  handlers.scene = [file = std::make_shared<SceneFile>([this] {
                      const std::lock_guard lock(mutex_);
                      return session_;
                    })](const HttpRequest& request) { return file->answer(request); };
  handlers.painting = std::make_shared<PaintedGoals>([this] { return session(); });
  handlers.blackout = [this](bool on) { return blackout(on); };
  handlers.identify = [this](const std::string& name, double seconds) { return identify(name, seconds); };
  handlers.aim = [this](const std::string& name, const Joints& joints, double level, double seconds) {
    return aim(name, joints, level, seconds);
  };
  handlers.preview = [this](const PreviewQuestion& question, const std::string& client) -> Result<std::string> {
    const auto last = published();
    if (!last) return tl::unexpected(Fault{Cause::timeout, {}, "nothing is lit yet: ask again", {}});
    const auto light = preview_.light(last->session, last->show, question.changes, question.reflections, client);
    if (!light) return tl::unexpected(light.error());
    return preview_text(last->session->rig, *light);
  };
  handlers.park = [this](const std::vector<std::string>& names) { return park(names); };
  handlers.hand_back = [this] { on_control_thread([this](Time at) { controller_.hand_back(at); }); };
  handlers.apply = [this](const std::string& plan_json, std::optional<double> fade_s) {
    return apply_json(plan_json, fade_s);
  };
  handlers.plan = [this] { return journal_.state().plan_json; };
  handlers.level = [this](const std::vector<std::string>& names, double level, const ByHandTimes& times) {
    return hold(ByHand::What::level, names, level, times);
  };
  handlers.goal = [this](const std::vector<std::string>& names, double lux, const ByHandTimes& times) {
    return hold(ByHand::What::goal, names, lux, times);
  };
  handlers.levels = [this](const std::vector<std::pair<std::string, double>>& levels, const ByHandTimes& times) {
    return hold_levels(levels, times);
  };
  handlers.release = [this](const std::vector<std::string>& names, std::optional<double> fade_s) {
    return release(names, fade_s);
  };
  handlers.bypass = [this](const std::vector<std::string>& names, bool on) { return bypass(names, on); };
  handlers.question = [this](const HandQuestion& question, double seconds) {
    return questions_.ask(question, from_seconds(seconds), now());
  };
  handlers.withdraw_question = [this](const std::string& id) { questions_.withdraw(id); };
  handlers.answer = [this](const std::string& id, const HandAnswer& answer) {
    return questions_.answer(id, answer, now());
  };
  handlers.start_job = [this](const std::string& kind) { return start_job(kind); };
  handlers.jobs = [this] { return jobs_.all(); };
  handlers.job = [this](const std::string& id) { return jobs_.at(id); };
  handlers.cancel_job = [this](const std::string& id) { return jobs_.cancel(id); };
  handlers.reload = [this] { return reload(); };
  return handlers;
}

void Daemon::send_program() {
  if (controller_.program().revision == sent_revision_) return;
  programs_.put(controller_.program());
  sent_revision_ = controller_.program().revision;
}

bool Daemon::run_commands(Time at) {
  std::deque<Command> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  for (Command& command : commands) {
    command.run(at);
    command.done.set_value();
  }
  return !commands.empty();
}

void Daemon::tick() {
  const Time at = now();
  const bool commanded = run_commands(at);
  devices_.clear();
  for (const auto& bus : buses_) {
    if (options_.stepped_driver) bus->turn(at);
    for (const LuxReading& reading : bus->take_readings()) controller_.reading(at, reading);
    const auto frames = bus->desk_frames();
    for (std::size_t part = 0; part < frames.size(); ++part) {
      controller_.desk(at, bus->first_desk() + part, frames[part]);
    }
    const auto health = bus->health();
    devices_.insert(devices_.end(), health.begin(), health.end());
  }
  controller_.health(at, devices_);
  controller_.step(at);
  send_program();
  tell_guardian(at);
  if (at - last_publish_ >= kPublishPeriod || commanded) publish(at);
}

void Daemon::publish(Time at) {
  last_publish_ = at;
  status_ = controller_.status(at);
  add_alarms(at);
  OutputFigures output;
  for (const auto& bus : buses_) {
    // The figures of the fastest bus that writes.
    const CycleStatistics& cycle = bus->statistics();
    if (!bus->writes()) continue;
    const double rate_hz = 1.0 / to_seconds(cycle.period());
    if (rate_hz <= output.rate_hz) continue;
    output = {rate_hz, cycle.count(), cycle.quantile_us(0.5), cycle.quantile_us(0.99), cycle.max_us(), bus->realtime()};
  }
  for (const auto& bus : buses_) {
    const auto spell = bus->lateness().spell(at);
    if (!spell) continue;
    const std::string& name = session_->rig.buses[bus->bus()].name;
    status_.alarms.push_back({false, name,
                              fmt::format("this computer is busy: bus \"{}\" was served up to {:.1f} s late; end what "
                                          "else runs here, or let Luxrig have real-time priority",
                                          name, to_seconds(spell->most)),
                              spell->since});
  }
  auto published = std::make_shared<const PublishedStatus>(PublishedStatus{session_, status_, devices_, output, at});
  const std::lock_guard lock(mutex_);
  published_ = std::move(published);
}

void Daemon::go_safe() { controller_.go_safe(now()); }

void Daemon::stop() {
  if (stopped_) return;
  stopped_ = true;
  if (http_) {
    // Serve handlers that wait for this thread; each would delay the end otherwise.
    auto ended = std::async(std::launch::async, [this] { http_->stop(); });
    while (ended.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) run_commands(now());
  }
  jobs_.stop();
  if (contacts_.joinable()) {
    contacts_.request_stop();
    contact_pressed_.release();
    contacts_.join();
  }
  buses_.clear();
  if (guardian_) guardian_->end();
}

}  // namespace luxrig
