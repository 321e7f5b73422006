/// Commands of clients: plans, parking, levels and goals by hand, bypass, and the reload of the rig file.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "core/tasks/rig_version.h"
#include "core/text/nearest.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrigd/by_hand_names.h"
#include "tools/luxrigd/daemon.h"
#include "tools/luxrigd/reload_check.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr Duration kContactFound = std::chrono::seconds(2);  // allowed for the first answer, or a retry
constexpr Duration kStillSaid = std::chrono::seconds(60);

std::vector<Problem> problem_with(const char* what, const Fault& fault, const char* mend) {
  return {{what, 0, 0, fault.detail, mend}};
}

const std::string& name_of(const Rig& rig, const ByHand& held) {
  return held.what == ByHand::What::level ? rig.fixtures[held.index].name : rig.points[held.index].name;
}

std::string value_text(const ByHand& held) {
  return held.what == ByHand::What::level ? fmt::format("level {:.4g}", held.value)
                                          : fmt::format("{:.4g} lx", held.value);
}

/// One line per entry.
std::string lines_of(const Rig& rig, const std::vector<ByHand>& held, Time at) {
  std::string text;
  for (const ByHand& one : held) {
    const std::string until =
        one.until ? fmt::format("for {:.0f} s", to_seconds(*one.until - at)) : std::string("until it is released");
    text += fmt::format("{}{}: {} by hand, {}{}", text.empty() ? "" : "\n", name_of(rig, one), value_text(one), until,
                        one.why.empty() ? "" : "; at present not so: " + one.why);
  }
  return text;
}

}  // namespace

std::shared_ptr<const Session> Daemon::session() const {
  const std::lock_guard lock(mutex_);
  return session_;
}

Result<std::size_t> Daemon::fixture_called(const std::string& name) const {
  const std::shared_ptr<const Session> session = this->session();
  const std::vector<Fixture>& fixtures = session->rig.fixtures;
  std::vector<std::string_view> names;
  for (std::size_t f = 0; f < fixtures.size(); ++f) {
    const std::string& own = fixtures[f].name;
    names.push_back(own);
    // An emitter's name is "housing/emitter": the housing's name alone also matches.
    if (own == name || (fixtures[f].housing && own.rfind(name + "/", 0) == 0)) return f;
  }
  return refusal(fmt::format("the rig has no fixture \"{}\": {}", name, mend_for_unknown(name, names, "it has none")));
}

Result<void> Daemon::identify(const std::string& name, double seconds) {
  const auto fixture = fixture_called(name);
  if (!fixture) return tl::unexpected(fixture.error());
  const auto done = ask_control_thread<Result<void>>(
      [this, f = *fixture, seconds](Time at) { return controller_.identify(at, f, from_seconds(seconds)); });
  return done.value_or(refusal("the control loop did not answer"));
}

Result<void> Daemon::aim(const std::string& name, const Joints& joints, double level, double seconds) {
  const auto fixture = fixture_called(name);
  if (!fixture) return tl::unexpected(fixture.error());
  Joints wanted = joints;
  wanted.beam_rad = session()->rig.fixtures[*fixture].joints.beam_rad;
  const auto done = ask_control_thread<Result<void>>([this, f = *fixture, wanted, level, seconds](Time at) {
    return controller_.aim(at, f, wanted, level, from_seconds(seconds));
  });
  return done.value_or(refusal("the control loop did not answer"));
}

Result<void> Daemon::park(const std::vector<std::string>& names) {
  std::vector<std::size_t> heads;
  for (const std::string& name : names) {
    const auto fixture = fixture_called(name);
    if (!fixture) return tl::unexpected(fixture.error());
    heads.push_back(*fixture);
  }
  const auto done = ask_control_thread<Result<void>>([this, heads](Time at) { return controller_.park(at, heads); });
  if (!done) return refusal("the control loop did not answer");
  if (!*done) return *done;
  const std::shared_ptr<const Session> session = this->session();
  const Rig& rig = session->rig;
  for (std::size_t f = 0; names.empty() && f < rig.fixtures.size(); ++f)
    if (rig.fixtures[f].park) heads.push_back(f);
  return journal_.keep([&](JournalState& state) {
    for (const std::size_t head : heads) {
      const std::string& name = rig.fixtures[head].name;
      if (std::find(state.parked.begin(), state.parked.end(), name) == state.parked.end()) state.parked.push_back(name);
    }
  });
}

// ---- jobs ----

Result<std::string> Daemon::start_job(const std::string& kind) {
  if (!options_.solve) return refusal("this daemon cannot solve");
  // The rig's files as they are when the job begins: goals may have been painted since they were read. The plan says for
  // which rig it was made, and apply() whether that is the one in force.
  return jobs_.start(kind, [this, file = session()->rig.file](const Watch& watch) -> Result<std::string> {
    const auto session = open_session(file);
    if (!session) return refusal(session.error().front().text());
    const auto plan = options_.solve(*session, watch);
    if (!plan) return tl::unexpected(plan.error());
    return to_json(*plan);
  });
}

// ---- plans ----

Checked<void> Daemon::apply(const Plan& plan, bool of_rig) {
  auto applied = apply(plan, to_json(plan), of_rig, Unsaved::goes_on);
  if (!applied) return tl::unexpected(std::move(applied.error()));
  return {};
}

Checked<std::string> Daemon::apply_json(const std::string& plan_json, std::optional<double> fade_s) {
  const auto plan = plan_from_json(plan_json, "plan");
  if (!plan) return tl::unexpected(plan.error());
  return apply(*plan, plan_json, false, Unsaved::is_refused, fade_s);
}

Checked<std::string> Daemon::apply(const Plan& plan, const std::string& plan_json, bool of_rig, Unsaved unsaved,
                                   std::optional<double> fade_s) {
  // Light is traced before the lock, so that other commands need not wait. If a reload came in between, once more.
  std::shared_ptr<const Session> session = this->session();
  auto look = look_for(plan, session->rig, "plan");
  if (!look) return tl::unexpected(look.error());
  auto model = options_.light_model(*session, look->joints);
  const std::lock_guard one_at_a_time(change_mutex_);
  if (const auto now_in_force = this->session(); now_in_force != session) {
    session = now_in_force;
    look = look_for(plan, session->rig, "plan");
    if (!look) return tl::unexpected(look.error());
    model = options_.light_model(*session, look->joints);
  }
  if (!model) {
    return tl::unexpected(std::vector<Problem>{
        {"plan", 0, 0, "what the rig gives with its heads turned so: " + model.error().detail, "solve again"}});
  }
  std::string note;
  {
    const std::lock_guard lock(mutex_);
    if (plan.made_for && *plan.made_for != version_) {
      note = fmt::format("made for another version of this rig ({} differ)", what_differs(*plan.made_for, version_));
    }
  }
  // An acknowledged plan survives a power cut. The plan at the start lights the rig even if it cannot be saved.
  const auto with_plan = [&](JournalState& state) {
    state.plan_json = plan_json;
    state.plan_of_rig = of_rig;
    state.parked.clear();
  };
  if (unsaved == Unsaved::is_refused) {
    if (const auto saved = journal_.save_first(with_plan); !saved)
      return tl::unexpected(problem_with("plan", saved.error(), "free disk space or mend the permissions"));
  } else if (unsaved == Unsaved::goes_on) {
    (void)journal_.keep(with_plan);
  }
  struct Applied {
    std::vector<ByHand> held;
    Time at;
    std::string waits;  ///< reason; empty if it does not wait
  };
  const auto applied = ask_control_thread<Applied>(
      [this, made_for = plan.made_for, look = std::move(*look), model = std::move(*model), fade_s](Time at) -> Applied {
        controller_.apply(at, look, model, fade_s);
        {
          const std::lock_guard lock(mutex_);
          plan_made_for_ = made_for;
          plan_at_ = at;
        }
        const ShowStatus status = controller_.status(at);
        // Heads go dark first when a plan begins: that is no wait.
        const bool waits = status.plan_waits && status.phase != Phase::moving;
        return {status.by_hand, at, waits ? status.detail : std::string()};
      });
  if (!applied)
    return tl::unexpected(std::vector<Problem>{
        {"plan", 0, 0, "the control loop has not come to it yet: the plan is saved, and in force when it does",
         "look at luxrig status before you apply it again"}});
  if (!applied->waits.empty())
    note += (note.empty() ? "" : "\n") + ("it waits until this is over: " + applied->waits);
  if (!applied->held.empty())
    note += (note.empty() ? "" : "\n") + lines_of(session->rig, applied->held, applied->at);
  return note;
}

// ---- state of the last daemon ----

Resumed Daemon::resume(const Journal::Left& left) {
  Resumed resumed;
  resumed.notes = left.complaints;
  if (!left.state) return resumed;
  const JournalState& saved = *left.state;
  // All at once: if this daemon is killed while it restores the parts, nothing is lost.
  (void)journal_.keep([&](JournalState& state) { state = saved; });
  // Blackout first: it holds whatever happens to the plan and to the next save.
  if (saved.blackout) {
    (void)blackout(true);
    controller_.blackout(now(), true);
  }
  restore_by_hand(saved.by_hand, resumed);
  restore_bypassed(saved.bypassed, resumed);
  if (!saved.plan_json.empty()) {
    const auto plan = plan_from_json(saved.plan_json, "the saved plan");
    const std::string differs =
        plan && plan->made_for && *plan->made_for != version_ ? what_differs(*plan->made_for, version_) : "";
    if (saved.plan_of_rig && !differs.empty()) {
      resumed.notes.push_back(fmt::format(
          "the rig file has changed since ({} differ): its goals are solved again, the saved plan is left", differs));
    } else {
      const auto applied = plan ? apply(*plan, saved.plan_json, saved.plan_of_rig, Unsaved::is_saved)
                                : Checked<std::string>(tl::unexpected(plan.error()));
      if (applied) {
        resumed.plan = true;
      } else {
        for (const Problem& problem : applied.error())
          resumed.notes.push_back("the saved plan is not taken up again: " + problem.text());
      }
      if (resumed.plan && !differs.empty())
        resumed.notes.push_back(fmt::format(
            "the rig file has changed since the plan that was in force was made ({} differ): the plan is held within "
            "the limits of the rig as it is now; luxrig solve and luxrig apply make one for it, --fresh starts without",
            differs));
    }
  }
  std::vector<std::size_t> heads;
  // The rig may have changed since.
  for (const std::string& name : saved.parked) {
    if (const auto head = fixture_called(name); head && session()->rig.fixtures[*head].park) heads.push_back(*head);
  }
  if (resumed.plan && !heads.empty()) on_control_thread([this, heads](Time at) { (void)controller_.park(at, heads); });
  return resumed;
}

void Daemon::restore_by_hand(const std::vector<SavedByHand>& saved, Resumed& resumed) {
  const Rig& rig = session()->rig;
  const double unix_s = unix_now_s();
  const Time at = now();
  std::vector<ByHand> held;
  std::vector<SavedByHand> kept;
  for (const SavedByHand& one : saved) {
    if (one.until_unix_s && *one.until_unix_s <= unix_s) continue;
    const auto find = [&](const auto& list) {
      const auto found =
          std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.name == one.name; });
      return static_cast<std::size_t>(found - list.begin());
    };
    ByHand by_hand{one.goal ? ByHand::What::goal : ByHand::What::level,
                   one.goal ? find(rig.points) : find(rig.fixtures), one.value};
    const std::size_t count = one.goal ? rig.points.size() : rig.fixtures.size();
    if (by_hand.index >= count || !by_hand.complaint(!one.goal && rig.fixtures[by_hand.index].switched).empty()) {
      resumed.notes.push_back(
          fmt::format("{} was set by hand to {:g}, which this rig cannot have: released", one.name, one.value));
      continue;
    }
    by_hand.since = at - from_seconds(std::clamp(unix_s - one.since_unix_s, 0.0, to_seconds(at - Time{})));
    if (one.until_unix_s) by_hand.until = at + from_seconds(*one.until_unix_s - unix_s);
    held.push_back(by_hand);
    kept.push_back(one);
  }
  if (kept.size() != saved.size()) (void)journal_.keep([&](JournalState& state) { state.by_hand = kept; });
  if (held.empty()) return;
  resumed.notes.push_back(fmt::format("{} set by hand {} again", held.size(), held.size() == 1 ? "is" : "are"));
  on_control_thread([this, held](Time now_then) { (void)controller_.hold(now_then, held); });
}

// ---- by hand ----

std::vector<SavedByHand> Daemon::held_by_hand(const Rig& rig, Time at) const {
  std::vector<SavedByHand> saved;
  const double unix_s = unix_now_s();
  for (const ByHand& held : controller_.by_hand()) {
    if (held.of_plan) continue;  // the plan has it
    SavedByHand one{held.what == ByHand::What::goal, name_of(rig, held), held.value,
                    unix_s - to_seconds(at - held.since), std::nullopt};
    if (held.until) one.until_unix_s = unix_s + to_seconds(*held.until - at);
    saved.push_back(std::move(one));
  }
  return saved;
}

Result<std::string> Daemon::hold(ByHand::What what, const std::vector<std::string>& names, double value,
                                 const ByHandTimes& times) {
  const std::lock_guard one_at_a_time(change_mutex_);
  const std::shared_ptr<const Session> session = this->session();
  auto wanted = what == ByHand::What::level ? luxrig::fixtures_called(session->rig, names)
                                            : luxrig::points_called(session->rig, names);
  if (!wanted) return tl::unexpected(wanted.error());
  for (ByHand& one : *wanted) one.value = value;
  return hold(session, std::move(*wanted), times);
}

/// A later one of the same fixture counts.
Result<std::string> Daemon::hold_levels(const std::vector<std::pair<std::string, double>>& levels,
                                        const ByHandTimes& times) {
  const std::lock_guard one_at_a_time(change_mutex_);
  const std::shared_ptr<const Session> session = this->session();
  std::vector<ByHand> wanted;
  for (const auto& [name, level] : levels) {
    auto called = luxrig::fixtures_called(session->rig, {name});
    if (!called) return tl::unexpected(called.error());
    for (ByHand& one : *called) {
      one.value = level;
      wanted.push_back(one);
    }
  }
  return hold(session, std::move(wanted), times);
}

Result<std::string> Daemon::hold(const std::shared_ptr<const Session>& session, std::vector<ByHand> wanted,
                                 const ByHandTimes& times) {
  struct Held {
    Result<void> done;
    std::string text;
    std::vector<SavedByHand> all;
  };
  const auto held = ask_control_thread<Held>(
      [this, session, &rig = session->rig, wanted = std::move(wanted), times](Time at) -> Held {
        std::vector<ByHand> timed = wanted;
        for (ByHand& one : timed) {
          one.since = at;
          if (times.for_s) one.until = at + from_seconds(*times.for_s);
        }
        Held out{controller_.hold(at, timed, times), {}, {}};
        if (!out.done) return out;
        std::vector<ByHand> fresh = controller_.status(at).by_hand;
        std::erase_if(fresh, [&](const ByHand& one) { return one.since != at; });
        out.text = lines_of(rig, fresh, at);
        out.all = held_by_hand(rig, at);
        return out;
      });
  if (!held) return tl::unexpected(Fault{Cause::timeout, {}, "the control loop did not answer", {}});
  if (!held->done) return tl::unexpected(held->done.error());
  if (const auto saved = journal_.keep([&](JournalState& state) { state.by_hand = held->all; }); !saved)
    return tl::unexpected(saved.error());
  return held->text;
}

Result<std::string> Daemon::release(const std::vector<std::string>& names, std::optional<double> fade_s) {
  const std::lock_guard one_at_a_time(change_mutex_);
  const std::shared_ptr<const Session> session = this->session();
  auto wanted = anything_called(session->rig, names.empty() ? std::vector<std::string>{"*"} : names);
  if (!wanted) return tl::unexpected(wanted.error());
  struct Released {
    std::size_t count = 0;
    std::vector<SavedByHand> all;
  };
  const auto released = ask_control_thread<Released>([this, session, wanted = *wanted, fade_s](Time at) -> Released {
    std::vector<std::size_t> fixtures, points;
    for (const ByHand& one : wanted) (one.what == ByHand::What::level ? fixtures : points).push_back(one.index);
    const std::size_t count = controller_.release(at, fixtures, points, fade_s);
    return {count, held_by_hand(session->rig, at)};
  });
  if (!released) return tl::unexpected(Fault{Cause::timeout, {}, "the control loop did not answer", {}});
  if (const auto saved = journal_.keep([&](JournalState& state) { state.by_hand = released->all; }); !saved)
    return tl::unexpected(saved.error());
  if (released->count == 0) return std::string("nothing of that was set by hand");
  return fmt::format("{} released", released->count);
}

// ---- devices that are bypassed ----

Result<std::string> Daemon::bypass(const std::vector<std::string>& names, bool on) {
  const std::lock_guard one_at_a_time(change_mutex_);
  const std::shared_ptr<const Session> session = this->session();
  const auto devices = devices_called(session->rig, names);
  if (!devices) return tl::unexpected(devices.error());
  struct Done {
    std::vector<std::string> all;
    std::string risk;
  };
  const auto done = ask_control_thread<Done>([this, session, devices = *devices, on](Time at) -> Done {
    controller_.bypass(at, devices.fixtures, devices.luxmeters, on);
    Done out;
    for (const Bypassed& one : controller_.status(at).bypassed) {
      const auto& asked = one.luxmeter ? devices.luxmeters : devices.fixtures;
      out.all.push_back(one.luxmeter ? session->rig.luxmeters[one.index].name : session->rig.fixtures[one.index].name);
      if (std::find(asked.begin(), asked.end(), one.index) != asked.end())
        out.risk += (out.risk.empty() ? "" : "\n") + one.risk;
    }
    return out;
  });
  if (!done) return tl::unexpected(Fault{Cause::timeout, {}, "the control loop did not answer", {}});
  if (const auto saved = journal_.keep([&](JournalState& state) { state.bypassed = done->all; }); !saved)
    return tl::unexpected(saved.error());
  return on ? done->risk : std::string("no longer bypassed: ") + fmt::format("{}", fmt::join(names, ", "));
}

void Daemon::restore_bypassed(const std::vector<std::string>& saved, Resumed& resumed) {
  Devices all;
  std::vector<std::string> kept;
  for (const std::string& name : saved) {
    const auto devices = devices_called(session()->rig, {name});
    if (!devices) {
      resumed.notes.push_back(fmt::format("{} was bypassed, and the rig has it no more", name));
      continue;
    }
    kept.push_back(name);
    all.fixtures.insert(all.fixtures.end(), devices->fixtures.begin(), devices->fixtures.end());
    all.luxmeters.insert(all.luxmeters.end(), devices->luxmeters.begin(), devices->luxmeters.end());
  }
  if (kept.empty()) return;
  resumed.notes.push_back(
      fmt::format("{} still bypassed: {}", fmt::join(kept, ", "), "luxrig bypass NAME --undo when it is mended"));
  (void)journal_.keep([&](JournalState& state) { state.bypassed = kept; });
  on_control_thread([this, all](Time at) { controller_.bypass(at, all.fixtures, all.luxmeters, true); });
}

// ---- a rig file that has changed ----

void Daemon::add_alarms(Time at) {
  if (const auto why = journal_.unsaved()) {
    if (!unsaved_since_) unsaved_since_ = at;
    status_.alarms.push_back({true, "",
                              fmt::format("what is set now would be forgotten if this program ended: {}; free disk "
                                          "space or mend the permissions, then set something again",
                                          *why),
                              *unsaved_since_});
  } else {
    unsaved_since_.reset();
  }
  if (unguarded_since_)
    status_.alarms.push_back({true, "",
                              fmt::format("nobody looks after the light if this program dies: its guardian {}; it is "
                                          "tried again",
                                          unguarded_.empty() ? std::string("ends as soon as it is started, perhaps as "
                                                                           "the rig file has changed: luxrig reload")
                                                             : "cannot be started: " + unguarded_),
                              *unguarded_since_});
  if (stood_still_at_ && at - *stood_still_at_ < kStillSaid)
    status_.alarms.push_back({false, "",
                              "this program stood still for longer than half a second, and its guardian had the light "
                              "meanwhile: something else takes this computer's time, or stopped it",
                              *stood_still_at_});
  add_contact_alarms(at);
  const std::lock_guard lock(mutex_);
  if (rig_file_watch_) {
    const auto changed = rig_file_watch_->changed();
    if (changed.empty() != !rig_file_changed_at_)
      rig_file_changed_at_ = changed.empty() ? std::nullopt : std::optional(at);
    if (rig_file_changed_at_) {
      std::vector<std::string> names;
      for (const auto& file : changed) names.push_back(file.filename().string());
      status_.alarms.push_back({false, "",
                                fmt::format("{} changed since the rig was read, and what runs is the rig as it was: "
                                            "luxrig reload takes the new one, whole or not at all",
                                            fmt::join(names, ", ")),
                                *rig_file_changed_at_});
    }
  }
  if (plan_made_for_ && *plan_made_for_ != version_) {
    status_.alarms.push_back(
        {plan_made_for_->light != version_.light, "",
         fmt::format("the plan in force was made for another version of this rig ({} differ): it is held within the "
                     "limits of the rig as it was read; {}luxrig solve and luxrig apply make one for it",
                     what_differs(*plan_made_for_, version_),
                     rig_file_changed_at_ ? "luxrig reload takes the rig file as it is now, or " : ""),
         plan_at_});
  }
}

void Daemon::add_contact_alarms(Time at) {
  contact_unknown_since_.resize(buses_.size());
  contact_pressed_since_.resize(buses_.size());
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    const auto contact = buses_[b]->contact();
    if (!contact) continue;
    const std::string& name = first_session_->rig.buses[buses_[b]->bus()].name;
    std::optional<Time>& since = contact_unknown_since_[b];
    if (contact != Contact::unknown) {
      since.reset();
    } else if (!since) {
      since = at;
    }
    if (since && at - *since > kContactFound)
      status_.alarms.push_back({true, name,
                                fmt::format("the blackout contact of bus \"{}\" does not answer, and could not ask for "
                                            "blackout: look at its unit and its wires",
                                            name),
                                *since});
    std::optional<Time>& pressed = contact_pressed_since_[b];
    if (contact != Contact::pressed) {
      pressed.reset();
    } else if (!pressed) {
      pressed = at;
    }
    if (pressed)
      status_.alarms.push_back({false, name,
                                fmt::format("the blackout contact of bus \"{}\" asks for blackout; when it is "
                                            "released, luxrig blackout off brings the light back",
                                            name),
                                *pressed});
  }
}

Checked<std::string> Daemon::reload() {
  const std::lock_guard one_at_a_time(change_mutex_);
  const std::shared_ptr<const Session> present = session();
  const std::string file = present->rig.file.string();
  if (!options_.solve)
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, "this daemon cannot read it again", "restart it"}});
  auto opened = open_session(present->rig.file);
  if (!opened) return tl::unexpected(std::move(opened.error()));
  const auto session = std::make_shared<Session>(std::move(*opened));
  const RigVersion version = version_of(session->rig, session->scene);
  const JournalState remembered = journal_.state();
  RigVersion version_before;
  {
    const std::lock_guard lock(mutex_);
    version_before = version_;
  }
  if (auto problems = needs_a_restart(present->rig, session->rig, version.light == version_before.light);
      !problems.empty())
    return tl::unexpected(std::move(problems));
  auto solved = options_.solve(*session, {});
  if (!solved) return tl::unexpected(problem_with(file.c_str(), solved.error(), "mend the rig file"));

  // The rig file's goals if they are in force; a person's plan stays, within the new rig's limits.
  const bool of_rig = remembered.plan_of_rig || remembered.plan_json.empty();
  const auto plan =
      of_rig ? Checked<Plan>(std::move(*solved)) : plan_from_json(remembered.plan_json, "the plan in force");
  if (!plan) return tl::unexpected(plan.error());
  auto look = look_for(*plan, session->rig, of_rig ? file : "the plan in force");
  if (!look) return tl::unexpected(std::move(look.error()));
  const auto joints_now =
      ask_control_thread<std::vector<Joints>>([this](Time) { return controller_.program().joints; });
  if (!joints_now)
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, "the control loop did not answer", "try again"}});
  auto model_now = options_.light_model(*session, *joints_now);
  if (!model_now) return tl::unexpected(problem_with(file.c_str(), model_now.error(), "try again"));
  auto model = options_.light_model(*session, look->joints);
  if (!model) return tl::unexpected(problem_with(file.c_str(), model.error(), "try again"));
  RoomView room = draw_room(*session);

  const auto saved = journal_.save_first([&](JournalState& state) {
    if (of_rig) state.plan_json = to_json(*plan);
    state.plan_of_rig = of_rig;
  });
  if (!saved)
    return tl::unexpected(problem_with(file.c_str(), saved.error(), "free disk space or mend the permissions"));
  // All by value: the loop may run this after our wait has timed out.
  const auto done = ask_control_thread<bool>(
      [this, session, version, made_for = plan->made_for, now_gives = std::move(*model_now), look = std::move(*look),
       model = std::move(*model), same_light = version.light == version_before.light, room = std::move(room)](Time at) {
        controller_.exchange_rig(at, session->rig, now_gives, same_light);
        controller_.apply(at, look, model);
        safe_levels_.clear();
        const std::lock_guard lock(mutex_);
        session_ = session;
        version_ = version;
        plan_made_for_ = made_for;
        plan_at_ = at;
        room_ = room;
        rig_file_changed_at_.reset();
        return true;
      });
  {
    auto watch = std::make_shared<RigFileWatch>(files_of(session->rig));
    const std::lock_guard lock(mutex_);
    watch.swap(rig_file_watch_);
  }
  if (!done)
    return tl::unexpected(std::vector<Problem>{{file, 0, 0,
                                                "the control loop has not come to it yet: the rig file is read, and in "
                                                "force when it does",
                                                "look at luxrig status before you reload again"}});
  const std::string differs = what_differs(version_before, version);
  return fmt::format("{} is in force{}; {}", file, differs.empty() ? "" : " (" + differs + " differ)",
                     of_rig ? "its goals were solved" : "the plan that was applied stays, within its limits");
}

}  // namespace luxrig
