#pragma once
/// Client requests to the daemon: request bodies become calls of its handlers, and what these return the answers. Which
/// path leads to which of them: route_table.h.

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/frames.h"
#include "core/show/by_hand.h"
#include "tools/http/kept_answer.h"
#include "tools/http/server.h"
#include "tools/luxrigd/hand_question.h"
#include "tools/luxrigd/jobs.h"

namespace luxrig {

class PaintedGoals;
struct PreviewQuestion;

/// The daemon's handlers. They are called from the server's threads; each must be safe to call from any thread.
struct HttpHandlers {
  std::function<HttpResponse(const HttpRequest&)> session, login, logout;  ///< AccessRoutes sets them
  std::function<std::string()> one_time_address;                           ///< HttpApi sets it
  std::function<nlohmann::json()> settings;                                ///< settings_of() what is in force
  std::function<void(nlohmann::json change)> record;                       ///< ChangeLog::add()
  std::function<std::string()> change_log;                                 ///< ChangeLog::newest()
  std::function<std::string()> status;     ///< JSON
  std::function<std::string(const std::string& version)> changes;  ///< JSON: the status since that version
  std::function<std::string()> universes;  ///< JSON
  std::function<std::shared_ptr<const KeptAnswer>()> rig;  ///< null until they are made
  std::function<std::string()> room_json;  ///< empty until it is drawn
  std::function<std::string()> room_png;   ///< empty without a scene
  std::function<HttpResponse(const HttpRequest&)> scene;  ///< SceneFile::answer()
  std::function<Result<void>(bool on)> blackout;
  /// Identifies a fixture by its light, for this many seconds.
  std::function<Result<void>(const std::string& fixture, double seconds)> identify;
  /// Turns a head by hand, lit to this level, for this many seconds.
  std::function<Result<void>(const std::string& fixture, const Joints& joints, double level, double seconds)> aim;
  /// What the light would be, as JSON. client: of whom the newest question wins. LightPreview::light() has the causes.
  std::function<Result<std::string>(const PreviewQuestion& question, const std::string& client)> preview;
  /// Heads by name; empty list = all.
  std::function<Result<void>(const std::vector<std::string>& fixtures)> park;
  std::function<void()> hand_back;  ///< gives the light to desks that wait for it
  /// Returns notes for a person, in lines; empty if there are none. fade_s: none = as the rig's looks.
  std::function<Checked<std::string>(const std::string& plan_json, std::optional<double> fade_s)> apply;
  std::function<std::string()> plan;  ///< JSON, in force; empty if there is none
  /// Set by hand. Names may contain * and ?. Returns text for a person.
  std::function<Result<std::string>(const std::vector<std::string>& fixtures, double level, const ByHandTimes& times)>
      level;
  std::function<Result<std::string>(const std::vector<std::string>& points, double lux, const ByHandTimes& times)> goal;
  /// Each fixture its own level, all at the same instant.
  std::function<Result<std::string>(const std::vector<std::pair<std::string, double>>& levels,
                                    const ByHandTimes& times)>
      levels;
  /// Fixtures and points; empty list = all.
  std::function<Result<std::string>(const std::vector<std::string>& names, std::optional<double> fade_s)> release;
  /// Takes these fixtures and luxmeters out of the show, or back in. Returns the risks, in lines.
  std::function<Result<std::string>(const std::vector<std::string>& names, bool on)> bypass;
  /// Asks a person in the room, for so long; the answer so far.
  std::function<std::optional<HandAnswer>(const HandQuestion& question, double seconds)> question;
  /// Asks no longer.
  std::function<void(const std::string& id)> withdraw_question;
  std::function<Result<void>(const std::string& id, const HandAnswer& answer)> answer;
  /// Starts a job of this kind; its id.
  std::function<Result<std::string>(const std::string& kind)> start_job;
  std::function<std::vector<Job>()> jobs;
  /// nullopt: there is none of this id.
  std::function<std::optional<Job>(const std::string&id)> job, cancel_job;
  std::shared_ptr<PaintedGoals> painting;  ///< null: this daemon has none
  /// Reloads the rig file, whole or not at all.
  std::function<Checked<std::string>()> reload;
};

/// Answers to requests, one function for each route. A body that is not as the route's schema says is refused with 400
/// and with what to send.
namespace answer_to {

using Handlers = const HttpHandlers&;
using Request = const HttpRequest&;

[[nodiscard]] HttpResponse session(Handlers handlers, Request request);
[[nodiscard]] HttpResponse login(Handlers handlers, Request request);
[[nodiscard]] HttpResponse logout(Handlers handlers, Request request);
[[nodiscard]] HttpResponse new_address(Handlers handlers, Request request);
[[nodiscard]] HttpResponse change_log(Handlers handlers, Request request);
[[nodiscard]] HttpResponse status(Handlers handlers, Request request);
/// The body is one server-sent event.
[[nodiscard]] HttpResponse events(Handlers handlers, Request request);
[[nodiscard]] HttpResponse universes(Handlers handlers, Request request);
[[nodiscard]] HttpResponse rig(Handlers handlers, Request request);
[[nodiscard]] HttpResponse scene(Handlers handlers, Request request);
[[nodiscard]] HttpResponse room(Handlers handlers, Request request);
[[nodiscard]] HttpResponse room_png(Handlers handlers, Request request);
[[nodiscard]] HttpResponse blackout(Handlers handlers, Request request);
[[nodiscard]] HttpResponse identify(Handlers handlers, Request request);
[[nodiscard]] HttpResponse aim(Handlers handlers, Request request);
[[nodiscard]] HttpResponse preview(Handlers handlers, Request request);
[[nodiscard]] HttpResponse park(Handlers handlers, Request request);
[[nodiscard]] HttpResponse hand_back(Handlers handlers, Request request);
[[nodiscard]] HttpResponse apply(Handlers handlers, Request request);
[[nodiscard]] HttpResponse plan(Handlers handlers, Request request);
[[nodiscard]] HttpResponse level(Handlers handlers, Request request);
[[nodiscard]] HttpResponse goal(Handlers handlers, Request request);
[[nodiscard]] HttpResponse release(Handlers handlers, Request request);
[[nodiscard]] HttpResponse bypass(Handlers handlers, Request request);
[[nodiscard]] HttpResponse question(Handlers handlers, Request request);
[[nodiscard]] HttpResponse answer(Handlers handlers, Request request);
[[nodiscard]] HttpResponse start_job(Handlers handlers, Request request);
[[nodiscard]] HttpResponse jobs(Handlers handlers, Request request);
[[nodiscard]] HttpResponse job(Handlers handlers, Request request);
[[nodiscard]] HttpResponse cancel_job(Handlers handlers, Request request);
[[nodiscard]] HttpResponse surface_goals(Handlers handlers, Request request);
[[nodiscard]] HttpResponse add_surface_goal(Handlers handlers, Request request);
[[nodiscard]] HttpResponse surface_goal(Handlers handlers, Request request);
[[nodiscard]] HttpResponse put_surface_goal(Handlers handlers, Request request);
[[nodiscard]] HttpResponse surface_patches(Handlers handlers, Request request);
[[nodiscard]] HttpResponse save_painting(Handlers handlers, Request request);
[[nodiscard]] HttpResponse reload(Handlers handlers, Request request);

}  // namespace answer_to

}  // namespace luxrig
