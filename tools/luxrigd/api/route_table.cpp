#include "tools/luxrigd/api/route_table.h"

#include <memory>

#include "core/goals/stroke.h"
#include "tools/luxrig/calibrate/hand_answer.h"
#include "tools/luxrigd/api/command_limits.h"
#include "tools/luxrigd/api/preview_json.h"
#include "tools/luxrigd/api/recorded.h"

namespace luxrig {
namespace {

using namespace schema;

constexpr const char* kAccountName = "^[0-9A-Za-z._@-]{1,64}$";

// Formats say of which kind a name is; the daemon refuses one that the rig does not have.
Schema name_of_a(const char* kind) { return {{"type", "string"}, {"format", kind}}; }
Schema names_of(const char* kind) { return list(name_of_a(kind), 1); }
Schema question_id() { return {{"type", "string"}, {"pattern", kQuestionId}}; }
Schema for_s() { return up_to(kLongestByHand_s, "held for so long; absent: until released"); }
Schema fade_s() { return between(kShortestFade_s, kLongestFade_s, "how long it takes to get there"); }
Schema place(const char* what) {
  Schema out = vector(what);
  out["items"] = between(-kFarthest_m, kFarthest_m);
  return out;
}
Schema short_text(int longest) { return {{"type", "string"}, {"minLength", 1}, {"maxLength", longest}}; }

Schema level_body() {
  const Schema level = between(0, 1);
  const Schema same = request({{"fixtures", names_of("fixtures")},
                               {"level", level},
                               maybe("for_s", for_s()),
                               maybe("fade_s", fade_s()),
                               never("levels")});
  Schema each = {{"type", "object"},
                 {"minProperties", 1},
                 {"propertyNames", name_of_a("fixtures")},
                 {"additionalProperties", level}};
  return any_of({same, request({{"levels", each},
                                maybe("for_s", for_s()),
                                maybe("fade_s", fade_s()),
                                maybe("measuring", yes_or_no("a rig in its safe look may be measured")),
                                never("fixtures"),
                                never("level")})});
}

Schema question_body() {
  Schema asked = request({{"id", question_id()},
                          {"text", short_text(400)},
                          {"position", place("m, world")},
                          {"normal", place("a direction, not 0")},
                          {"step", count(1, 1e6, "at most `steps`")},
                          {"steps", count(1, 1e6)},
                          {"readings", count(0, 1e6)},
                          {"for_s", up_to(kLongestAsked_s)},
                          maybe("fixture", short_text(201)),
                          maybe("known_to", between(0, 1000)),
                          maybe("known_to_worst", between(0, 1000)),
                          maybe("withdrawn", Schema{{"const", false}})});
  asked["dependentSchemas"] = {{"fixture", request({{"level", between(0, 1)}})}};
  return any_of({asked, request({{"id", question_id()}, {"withdrawn", yes()}})});
}

Schema answer_body() {
  return any_of({request({{"id", question_id()}, {"what", one_of_texts({"reading"})}, {"lux", between(0, kMostLux)}}),
                 request({{"id", question_id()}, {"what", one_of_texts({"skip", "other_place", "end"})}})});
}

Schema role_name() { return one_of_texts({"look", "operate", "configure"}); }
Schema surface_place() {
  return request(
      {{"position", place("m, world, on the surface")}, {"normal", place("of length 1, to the side that is meant")}});
}
Schema stroke_body(const char* kind, const std::vector<Key>& keys) {
  Schema path = list(surface_place(), 1);
  if (std::string(kind) != name_of(StrokeKind::brush)) path["maxItems"] = 1;
  return request(both({{"kind", one_of_texts({kind})}, {"path", path}}, keys));
}
Schema lux_of_stroke() { return between(0, kMaxStroke_lx); }
Schema painting_body() {
  const Schema stroke =
      any_of({stroke_body(name_of(StrokeKind::brush),
                          {{"lux", lux_of_stroke()}, {"radius_m", at_least(0)}, {"falloff", between(0, 1)}}),
              stroke_body(name_of(StrokeKind::bucket), {{"lux", lux_of_stroke()}}),
              stroke_body(name_of(StrokeKind::selective), {{"lux", lux_of_stroke()}}),
              stroke_body(name_of(StrokeKind::eraser), {})});
  return request({{"luxrig_painting", Schema{{"const", 1}}}, {"strokes", list(stroke)}});
}
Schema painting_answer() {
  return answer({{"name", text()},
                 {"version", text("the ETag without its quotes")},
                 {"saved", yes_or_no("the goal's file has these strokes")},
                 {"luxrig_painting", Schema{{"const", 1}}},
                 {"strokes", list(Schema{{"type", "object"}})}});
}
Schema surface_goal_answer() {
  return answer({{"name", text()},
                 {"version", text("of its strokes")},
                 {"strokes", count()},
                 {"saved", yes_or_no("its file has these strokes")},
                 {"in_force", yes_or_no("false: it waits for a reload")},
                 {"patch_m", number()},
                 maybe("max_lux", number()),
                 maybe("trouble", text("its strokes cannot be read, and why"))});
}

Schema done(const char* key) { return answer({{key, yes()}, {"text", text("for a person, in lines")}}); }

ApiAnswer ok(Schema body, const char* what = "done") { return {200, what, std::move(body)}; }
ApiAnswer refused() {
  return {400, "refused, with the reason: the body is not as its schema says, or the rig does not have it so",
          ref("Refusal")};
}
ApiAnswer failed() { return {500, "the disk or a bus has not taken it: the text says what holds", ref("Refusal")}; }

ApiAnswer being_drawn() { return {503, "the room is being drawn: ask again in a second", ref("Refusal")}; }

ApiAnswer no_surface_goal() { return {404, "the rig has no such surface goal", ref("Refusal")}; }
ApiAnswer not_cut_yet() {
  return {503, "the surfaces are being cut into patches: ask again in a second", ref("Refusal")};
}
ApiAnswer files_differ() {
  return {409, "the rig's files are not as they were read, or do not allow it", ref("Refusal")};
}

ApiAnswer no_job() { return {404, "there is no such job", ref("Refusal")}; }

/// With an ETag.
ApiRoute kept(ApiRoute route) {
  route.answers.push_back({304, "the client has it: If-None-Match", nullptr, nullptr});
  route.kept = true;
  return route;
}
ApiRoute slow(ApiRoute route) {
  route.slow = true;
  return route;
}
/// With If-Match.
ApiRoute matched(ApiRoute route) {
  Schema stale = painting_answer();
  stale["properties"]["error"] = text("for a person");
  stale["required"].push_back("error");
  route.answers.push_back({412, "it has other strokes than If-Match says: these", stale});
  route.matched = true;
  return route;
}
ApiRoute with(std::vector<ApiParameter> parameters, ApiRoute route) {
  route.parameters = std::move(parameters);
  return route;
}

std::vector<ApiRoute> made_table() {
  const Role look = Role::look, operate = Role::operate, configure = Role::configure;
  const Schema none;
  return {
      {"GET",
       "/api/session",
       Role::anybody,
       "who asks, and what they may do",
       none,
       {ok(answer({{"open", yes_or_no("the daemon knows who asks")},
                   maybe("name", text()),
                   maybe("role", role_name()),
                   {"login", yes_or_no("it has accounts, with which one can log in")},
                   maybe("problem", text("why the daemon does not use its newest accounts or certificate"))}),
           "who it is")},
       answer_to::session},
      slow({"POST",
            "/api/login",
            Role::anybody,
            "opens this browser for a person with an account",
            request({{"name", Schema{{"type", "string"}, {"pattern", kAccountName}}}, {"password", short_text(256)}}),
            {ok(answer({{"name", text()}, {"role", role_name()}}), "open; with the session's cookie"),
             refused(),
             {401, "wrong name or password", ref("Refusal")},
             {404, "this daemon has no accounts", ref("Refusal")},
             {429, "too many wrong attempts: Retry-After says in how many seconds the next may come", ref("Refusal")},
             {503, "others log in just now: try again", ref("Refusal")}},
            answer_to::login,
            kMaxShortBytes}),
      {"POST",
       "/api/logout",
       look,
       "ends this browser's session",
       none,
       {ok(answer({{"logged_out", yes()}}))},
       answer_to::logout},
      {"POST",
       "/api/session",
       configure,
       "makes an address that opens one browser, once, within ten minutes",
       none,
       {ok(answer({{"address", text()}}))},
       answer_to::new_address},
      {"GET",
       "/api/changes",
       look,
       "who changed what, from where: the newest 200, the newest last",
       none,
       {ok(list(ref("Change")), "a list of changes")},
       answer_to::change_log},
      with({{"since", "version of an answer before, or nothing: the answer has what changed since, or all of it"}},
           {"GET",
            "/api/status",
            look,
            "all that is known of the running rig; with `since` only what changed",
            none,
            {ok(any_of({ref("Status"), ref("StatusChanges"), {{"type", "object"}, {"maxProperties", 0}}}),
                "the status; empty in the first moment")},
            answer_to::status}),
      {"GET",
       "/api/events",
       look,
       "the status as server-sent events, five a second",
       none,
       {{200, "each: event: status, data as GET /api/status", nullptr, "text/event-stream"},
        {503, "too many pages are open", ref("Refusal")}},
       answer_to::events,
       0,
       false,
       true},
      {"GET",
       "/api/universes",
       look,
       "the slots of each universe, as DMX buses carry them",
       none,
       {ok(list(ref("Universe")), "a list of universes")},
       answer_to::universes},
      kept({"GET",
            "/api/rig",
            look,
            "what the rig is: all that only a reload changes",
            none,
            {ok(ref("Rig"), "the rig"), being_drawn()},
            answer_to::rig}),
      kept({"GET",
            "/api/scene",
            look,
            "the room's geometry as binary glTF: metres, +Y up (world x, y, z is x, z, -y there); one primitive per "
            "material, with its reflectance as base colour",
            none,
            {{200, "the scene", nullptr, "model/gltf-binary"},
             {404, "this rig has no scene", ref("Refusal")},
             {413, "the scene is too large for a browser", ref("Refusal")}},
            answer_to::scene}),
      {"GET",
       "/api/room",
       look,
       "bounds of the room, and where its picture from above lies",
       none,
       {ok(ref("Room"), "the room"), being_drawn()},
       answer_to::room},
      {"GET",
       "/api/room.png",
       look,
       "the room from above, cut below the ceiling",
       none,
       {{200, "a picture", nullptr, "image/png"}, {404, "this rig has no scene to draw", ref("Refusal")}},
       answer_to::room_png},
      {"POST",
       "/api/blackout",
       operate,
       "blackout on, or off",
       request({{"on", yes_or_no()}}),
       {ok(answer({{"blackout", yes_or_no()}})), refused(), failed()},
       answer_to::blackout,
       kMaxShortBytes,
       true},
      {"POST",
       "/api/identify",
       operate,
       "a fixture blinks or nods",
       request({{"fixture", name_of_a("fixture")}, maybe("seconds", up_to(kIdentifyAtMost_s))}),
       {ok(answer({{"seconds", number()}})), refused()},
       answer_to::identify},
      {"POST",
       "/api/aim",
       operate,
       "turns a head by hand, lit, for a while",
       request({{"fixture", name_of_a("fixture")},
                {"pan_deg", number()},
                {"tilt_deg", number()},
                {"level", between(0, 1)},
                {"for_s", up_to(kIdentifyAtMost_s)}}),
       {ok(answer({{"for_s", number()}})), refused()},
       answer_to::aim},
      {"POST",
       "/api/preview",
       look,
       "what the light would be with other levels or aims; nothing moves",
       preview_body(),
       {ok(preview_answer(), "the predicted light"),
        refused(),
        {409, "a newer question of this client has taken its place", ref("Refusal")},
        {503, "another client's is being computed, or nothing is lit yet: ask again", ref("Refusal")}},
       answer_to::preview},
      {"POST",
       "/api/park",
       operate,
       "sends heads, or all that can, to their place of rest, dark",
       request({maybe("fixtures", list(name_of_a("fixture")))}),
       {ok(answer({{"parked", yes()}})), refused(), failed()},
       answer_to::park},
      {"POST",
       "/api/hand-back",
       operate,
       "gives the light to lighting desks that wait for it",
       none,
       {ok(answer({{"handed_back", yes()}}))},
       answer_to::hand_back},
      with({{"fade_s", "how long the light takes to get there: from 0.1 to 600; absent: as the rig's looks"}},
           {"POST",
            "/api/apply",
            operate,
            "puts a plan in force",
            ref("Plan"),
            {ok(done("applied"), "it is in force, and on disk"),
             refused(),
             {503, "others are sending files just now: try again", ref("Refusal")}},
            answer_to::apply,
            kMaxPlanBytes}),
      {"GET",
       "/api/plan",
       look,
       "the plan in force, as it was applied or solved",
       none,
       {ok(ref("Plan"), "the plan"), {404, "no plan is in force yet", ref("Refusal")}},
       answer_to::plan},
      {"POST",
       "/api/jobs",
       operate,
       "starts a job: solve finds a plan for what the rig file asks, and does not apply it",
       request({{"kind", one_of_texts({"solve"})}}),
       {ok(answer({{"id", text()}}), "it waits or runs"), refused(), {409, "too many jobs wait", ref("Refusal")}},
       answer_to::start_job},
      {"GET",
       "/api/jobs",
       look,
       "the jobs of this daemon, the newest last",
       none,
       {ok(list(ref("Job")), "a list of jobs")},
       answer_to::jobs},
      {"GET",
       "/api/jobs/{id}",
       look,
       "a job with its result; one of an earlier daemon is lost, but for its plan",
       none,
       {ok(ref("JobWithPlan"), "the job"), no_job()},
       answer_to::job},
      {"DELETE",
       "/api/jobs/{id}",
       operate,
       "cancels a job; its best so far is its result, if it has one",
       none,
       {ok(ref("JobWithPlan"), "the job, which ends soon"), no_job()},
       answer_to::cancel_job},
      {"POST",
       "/api/level",
       operate,
       "holds fixtures at a level by hand",
       level_body(),
       {ok(done("held"), "held, and on disk"), refused(), failed()},
       answer_to::level},
      {"POST",
       "/api/goal",
       operate,
       "holds points at a goal by hand",
       request({{"points", names_of("points")},
                {"goal_lux", at_least(0)},
                maybe("for_s", for_s()),
                maybe("fade_s", fade_s())}),
       {ok(done("held"), "held, and on disk"), refused(), failed()},
       answer_to::goal},
      {"POST",
       "/api/release",
       operate,
       "releases what is held by hand",
       any_of(
           {request({{"all", yes()}, never("names"), maybe("fade_s", fade_s())}),
            request(
                {{"names", names_of("anything")}, maybe("all", Schema{{"const", false}}), maybe("fade_s", fade_s())})}),
       {ok(done("released"), "released, and on disk"), refused(), failed()},
       answer_to::release},
      {"POST",
       "/api/bypass",
       operate,
       "the show goes on without devices that have failed, or with them again",
       request({{"names", names_of("devices")}, {"on", yes_or_no()}}),
       {ok(done("done"), "done, and on disk; the text is the risk"), refused(), failed()},
       answer_to::bypass},
      {"POST",
       "/api/question",
       operate,
       "asks a person in the room for a reading, or no longer",
       question_body(),
       {ok(any_of({answer({{"asked", yes()}, maybe("answer", ref("HandAnswer"))}), answer({{"withdrawn", yes()}})}),
           "asked, with the answer so far; or withdrawn"),
        refused()},
       answer_to::question},
      {"POST",
       "/api/answer",
       operate,
       "answers that question",
       answer_body(),
       {ok(answer({{"taken", yes()}})),
        refused(),
        {409, "it is not asked any more, or has been answered", ref("Refusal")}},
       answer_to::answer,
       kMaxShortBytes},
      {"GET",
       "/api/surface-goals",
       look,
       "goals that are painted on surfaces",
       none,
       {ok(list(surface_goal_answer()), "a list of them")},
       answer_to::surface_goals},
      {"POST",
       "/api/surface-goals",
       configure,
       "a new one, without strokes, at the end of the rig file; in force after a reload",
       request({{"name", short_text(100)}, maybe("max_lux", between(0, 1e7))}),
       {ok(answer({{"added", yes()}}), "it is in the rig file"), refused(), files_differ(), being_drawn(), failed()},
       answer_to::add_surface_goal},
      {"GET",
       "/api/surface-goals/{name}",
       look,
       "the strokes of a surface goal, with an ETag",
       none,
       {ok(painting_answer(), "its strokes"), no_surface_goal(), files_differ()},
       answer_to::surface_goal},
      matched(
          {"PUT",
           "/api/surface-goals/{name}",
           operate,
           "makes these a surface goal's strokes, until they are saved in memory alone; the light does not change",
           painting_body(),
           {ok(answer({{"version", text("the new ETag without its quotes")},
                       {"strokes", count()},
                       {"patches", list(count())},
                       {"lux", list(or_null(number()))}}),
               "patches whose lux changed, as GET /api/surface-patches/{name} counts them; null: no longer painted"),
            refused(), no_surface_goal(), files_differ(), not_cut_yet()},
           answer_to::put_surface_goal,
           kMaxPaintingBytes}),
      kept({"GET",
            "/api/surface-patches/{name}",
            look,
            "the patches of a surface goal's surfaces and their lux, as tools/luxrigd/api/patch_file.h has them",
            none,
            {{200, "the patches", nullptr, "application/octet-stream"},
             no_surface_goal(),
             files_differ(),
             {413, "they are too many for a browser", ref("Refusal")},
             not_cut_yet()},
            answer_to::surface_patches}),
      {"POST",
       "/api/save-painting",
       operate,
       "writes strokes and points of surface goals, or of all, beside the rig file; a reload or a job asks for them",
       request({maybe("goals", list(name_of_a("surface goal")))}),
       {ok(done("saved"), "they are on disk"), refused(), no_surface_goal(), files_differ(), failed(), not_cut_yet()},
       answer_to::save_painting},
      {"POST",
       "/api/reload",
       configure,
       "reads the rig file again, whole or not at all",
       none,
       {ok(done("reloaded")), refused()},
       answer_to::reload},
  };
}

}  // namespace

const std::vector<ApiRoute>& route_table() {
  static const std::vector<ApiRoute> table = made_table();
  return table;
}

std::vector<ApiAnswer> common_refusals(const ApiRoute& route) {
  std::vector<ApiAnswer> all = {{400, "no HTTP request", ref("Refusal")}};
  if (route.role != Role::anybody) all.push_back({401, "the daemon does not know who asks", ref("Refusal")});
  all.push_back({403, "from another host, origin or site, or of a role that may not", ref("Refusal")});
  all.push_back({405, "the route is not for this method", ref("Refusal")});
  all.push_back({413, "the body is too long", ref("Refusal")});
  all.push_back({415, "the body is not application/json", ref("Refusal")});
  all.push_back({431, "the headers are too long", ref("Refusal")});
  return all;
}

std::vector<HttpRoute> http_routes(HttpHandlers handlers) {
  const auto to = std::make_shared<const HttpHandlers>(std::move(handlers));
  std::vector<HttpRoute> routes;
  for (const ApiRoute& route : route_table())
    routes.push_back({route.method, route.path,
                      [to, &route](const HttpRequest& request) { return recorded(route, *to, request); },
                      route.max_body_bytes, route.urgent, static_cast<int>(route.role), route.events, route.slow});
  return routes;
}

}  // namespace luxrig
