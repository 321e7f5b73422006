// luxrig: the table of subcommands.
#include <CLI/CLI.hpp>

#include "tools/bench/bench.h"
#include "tools/command_line/choice.h"
#include "tools/command_line/installed.h"
#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/luxrig/camera_command.h"
#include "tools/luxrig/command.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/compute_arguments.h"
#include "tools/luxrig/render_command.h"
#include "tools/luxrigd/run_options.h"

namespace {

using namespace luxrig;

void add_model(CLI::App& command, ComputeOptions& compute) {
  add_choice<Model, Model>(
      command, "--model", compute.model,
      "how light is computed; auto: the cheapest that meets the error; direct: no interreflection",
      {{"auto", Model::automatic}, {"direct", Model::direct}, {"gather", Model::gather}, {"path", Model::path}},
      {{"cache", "is refused, as its error bars were too short to be believed: use gather or path"}});
  command.add_flag("--strict", compute.strict, "exit code 1 when the wanted error is not reached (else a warning)");
  add_compute(command, compute);
}

void add_client(CLI::App& command, ClientArguments& client, bool with_json = true) {
  command.add_option("--port", client.port, "port of the daemon's page")->check(CLI::Range(1, 65535));
  command.add_option("--token", client.token, "file with the daemon's token, if it is another user's");
  if (with_json) command.add_flag("--json", client.json, "print what the daemon answers");
}

void add_rdm(CLI::App& command, RdmArguments& rdm, int& code) {
  command.require_subcommand(1);
  const auto add_search = [&rdm](CLI::App& one) {
    one.add_option("--node", rdm.node, "ask this node only (IPv4 address, with or without :port)");
    one.add_option("--broadcast", rdm.broadcast, "where nodes are asked: the lighting network's");
    one.add_option("--universe", rdm.universe, "only this Art-Net port address; of a widget, what its line is called")
        ->check(CLI::Range(0, 32767));
    one.add_option("--seconds", rdm.seconds, "how long to wait for the nodes' tables of devices")

        ->check(CLI::Range(0.1, 600.0));
    one.add_flag("--rediscover", rdm.rediscover, "have the nodes search their lines anew");
    one.add_flag("--usb", rdm.usb, "on the line of an ENTTEC DMX USB Pro, which puts out no levels meanwhile");
    one.add_option("--usb-serial", rdm.usb_serial, "of the widget with this serial number");
    one.add_option("--usb-port", rdm.usb_port, "of the widget that is plugged in there, such as 1-1.4");
    one.add_option("--usbip", rdm.usbip, "of a widget behind this USB/IP server, such as a simulated one (IPv4:port)");
    one.add_flag("--json", rdm.json, "print JSON");
  };
  auto* list = command.add_subcommand("list", "a table of all devices");
  add_search(*list);
  list->add_flag("--toml", rdm.toml, "print [[fixture]] entries for a rig file");
  list->callback([&] { code = run_rdm_list(rdm); });
  auto* get = command.add_subcommand("get", "read one parameter of a device");
  get->add_option("UID", rdm.uid, "which device")->required();
  get->add_option("PARAMETER", rdm.parameter, "its name (device_info, lamp_hours …) or number (0x8001)")->required();
  get->add_option("INDEX", rdm.value, "of which sensor (from 0) or personality (from 1)");
  add_search(*get);
  get->callback([&] { code = run_rdm_get(rdm); });
  auto* set = command.add_subcommand("set", "set one parameter of a device");
  set->add_option("UID", rdm.uid, "which device")->required();
  set->add_option("PARAMETER", rdm.parameter, "which")
      ->required()
      ->check(one_of({"address", "label", "personality", "identify"}));
  set->add_option("VALUE", rdm.value, "1 to 512, a text, a number, on or off")->required();
  add_search(*set);
  set->callback([&] { code = run_rdm_set(rdm); });
}

/// How help and the man page sort the commands.
void group(CLI::App& app, const char* title, std::initializer_list<const char*> commands) {
  for (const char* command : commands) app.get_subcommand(command)->group(title);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("sets a lighting rig to goals in lux, measures and corrects it", "luxrig");
  begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrig ") + kVersion, "print version and commit");
  app.require_subcommand(1);
  int code = kExitOk;

  CheckArguments check;
  auto* command = app.add_subcommand("check", "validate a rig and print what was understood");
  add_rig_option(*command, check.rig);
  command->add_flag("--json", check.json, "print JSON");
  command->add_flag("--outputs", check.outputs, "also say what each output does when data stops");
  command->callback([&] { code = run_check(check); });

  std::filesystem::path init_folder;
  command = app.add_subcommand("init", "a commented rig to start from, in a folder of that name");
  command->add_option("NAME", init_folder, "folder to make")->required();
  command->callback([&] { code = run_init(init_folder); });

  ImportArguments import_mvr;
  command =
      app.add_subcommand("import", "make a rig folder of an MVR file: positions, orientation, patch, personalities");
  command->add_option("FILE", import_mvr.file, "MVR file")->required();
  command->add_option("-o,--output", import_mvr.rig_folder, "folder to write rig.toml and the GDTF files to")
      ->required();
  command->callback([&] { code = run_import(import_mvr); });

  EvaluateArguments evaluate;
  command = app.add_subcommand("evaluate", "lux at every measurement point and luxmeter");
  add_rig_option(*command, evaluate.rig);
  command->add_option("--levels", evaluate.levels_plan, "levels of this plan (else every fixture at 100 %)");
  add_model(*command, evaluate.compute);
  command->add_flag("--json", evaluate.json, "print JSON");
  command->callback([&] { code = run_evaluate(evaluate); });

  SolveArguments solve;
  command = app.add_subcommand("solve", "do what the rig's tasks ask, and write a plan");
  add_rig_option(*command, solve.rig);
  command->add_option("-o,--output", solve.output, "write the plan here");
  add_model(*command, solve.compute);
  command->add_flag("--json", solve.json, "print the plan");
  command->callback([&] { code = run_solve(solve); });

  RenderOptions render;
  std::filesystem::path render_plan;
  std::vector<double> eye, target;
  std::string false_colour, exposure, white_balance;
  command = app.add_subcommand("render",
                               "a picture of the lit rig, a false-colour map of lux, or why its lights are "
                               "where they are");
  add_rig_option(*command, render.rig);
  auto* with_plan =
      command->add_option("PLAN", render_plan, "levels of this plan (else every fixture at its highest level)");
  command->add_option("-o,--output", render.output, "picture to write: .png or .jpg")->required();
  auto* with_false_colour =
      command->add_option("--false-colour", false_colour, "lux: a map of illuminance with a scale")
          ->check(one_of({"lux"}));
  auto* with_show =
      add_choice<std::optional<ShowWhat>, ShowWhat>(
          *command, "--show", render.show,
          "why: an object's curvature, its interest points, its features, the histogram of shadow directions, the "
          "domain where lights may hang; or where the beams go",
          {{"curvature", ShowWhat::curvature},
           {"interest", ShowWhat::interest},
           {"features", ShowWhat::features},
           {"histogram", ShowWhat::histogram},
           {"domain", ShowWhat::domain},
           {"beams", ShowWhat::beams}})
          ->excludes(with_false_colour);
  command->add_option("--object", render.object, "with --show: whose relief (else the only one from a mesh file)")
      ->needs(with_show);
  command->add_option("--lights", render.lights, "with --show histogram: so many directions are chosen")
      ->check(CLI::Range(1, 64))
      ->needs(with_show);
  command->add_option("--width", render.width_px, "pixels")->check(CLI::Range(16, 8192));
  command->add_option("--height", render.height_px, "pixels")->check(CLI::Range(16, 8192));
  auto* with_eye = command->add_option("--eye", eye, "x y z [m] of the viewer")->expected(3);
  auto* with_target = command->add_option("--target", target, "x y z [m] looked at")->expected(3);
  command->add_option("--fov-deg", render.vertical_fov_deg, "vertical field of view (60; with --show 30)")
      ->check(CLI::Range(1.0, 170.0));
  command
      ->add_option("--exposure", exposure,
                   "stops brighter (+1) or darker (-1) than metered, or the luminance shown white: 300cd/m2")
      ->check(CLI::Validator(
          [](std::string& text) {
            return exposure_of(text) ? "" : "write stops from -20 to 20 (+1), or a luminance (300cd/m2)";
          },
          ""))
      ->excludes(with_false_colour);
  command
      ->add_option("--white-balance", white_balance,
                   "what is shown neutral: light as of the lamps in use (lamps, the default), daylight, or a colour "
                   "temperature (2700K)")
      ->check(CLI::Validator(
          [](std::string& text) {
            return white_balance_of(text) ? "" : "write lamps, daylight, or 1667 to 25000 with or without K";
          },
          ""))
      ->excludes(with_false_colour);
  command->add_option("--max-lx", render.max_lx, "top of the false-colour scale")->check(CLI::PositiveNumber);
  command->add_option("--max-error", render.max_error, "noise at which the picture is done")
      ->check(CLI::Range(1e-4, 1.0));
  command->add_option("--seconds", render.seconds, "or after this time")->check(CLI::PositiveNumber);
  command->add_option("--passes", render.passes, "or after so many samples per pixel, whatever the time")
      ->check(CLI::Range(1, 65536));
  command->add_option("--threads", render.threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
  command->callback([&] {
    if (*with_plan) render.plan = render_plan;
    if (*with_eye) render.eye_world_m = Vec3(eye[0], eye[1], eye[2]);
    if (*with_target) render.target_world_m = Vec3(target[0], target[1], target[2]);
    render.false_colour = !false_colour.empty();
    if (!exposure.empty()) render.exposure = *exposure_of(exposure);
    if (!white_balance.empty()) render.white_balance = *white_balance_of(white_balance);
    code = run_render(render);
  });

  RunArguments run;
  command = app.add_subcommand("run", "run the rig: light, measure, correct, hold (the daemon in the foreground)");
  add_run_options(*command, run);
  command->callback([&] { code = run_rig(run); });

  DevicesArguments devices;
  command = app.add_subcommand(
      "devices", "what is there to be driven: nodes, sources, USB widgets, serial ports, CAN interfaces, cameras");
  command->add_option("--seconds", devices.seconds, "how long to listen")->check(CLI::Range(0.1, 600.0));
  command->add_option("--broadcast", devices.broadcast, "where Art-Net nodes are asked: the lighting network's");
  command->add_option("--interface", devices.interface, "network interface by which sACN sources are heard");
  command->add_flag("--json", devices.json, "print the list as JSON");
  command->callback([&] { code = run_devices(devices); });

  RdmArguments rdm;
  add_rdm(*app.add_subcommand("rdm",
                              "devices behind Art-Net nodes or a USB widget: list them, read and set their parameters"),
          rdm, code);

  CameraArguments camera;
  add_camera_command(*app.add_subcommand("camera", "take a picture with a rig's camera, or check that camera"), camera,
                     code);

  ClientArguments client;
  std::filesystem::path plan;
  command = app.add_subcommand("apply", "have the running daemon fade to a plan");
  command->add_option("PLAN", plan, "plan file (JSON)")->required();
  add_client(*command, client);
  command->callback([&] { code = run_apply(client, plan); });

  command = app.add_subcommand("status", "what the running daemon does and how its devices are");
  add_client(*command, client);
  command->callback([&] { code = run_status(client); });

  command = app.add_subcommand("page", "an address that opens the running daemon's page in one browser, once");
  add_client(*command, client);
  command->callback([&] { code = run_page(client); });

  bool lift = false;
  std::string blackout_state;
  command = app.add_subcommand("blackout", "all light off at once; `blackout off` lifts it");
  command->add_option("STATE", blackout_state, "on if left out")->check(one_of({"on", "off"}));
  command->add_flag("--off", lift, "lift the blackout");
  add_client(*command, client);
  command->callback([&] { code = run_blackout(client, !lift && blackout_state != "off"); });

  command = app.add_subcommand("hand-back", "lighting desks that are back and wait for it get the light");
  add_client(*command, client);
  command->callback([&] { code = run_hand_back(client); });

  std::vector<std::string> held;
  std::string held_for;
  command = app.add_subcommand("level", "hold fixtures at a level by hand, until they are released");
  command->add_option("FIXTURE..LEVEL", held, "names (* and ? for several), then 0…1 or 0%…100%")->required();
  command->add_option("--for", held_for, "for how long: 90s, 10min, 2h (else until luxrig release)");
  add_client(*command, client);
  command->callback([&] { code = run_level(client, held, held_for); });

  command = app.add_subcommand("goal", "hold points at another goal by hand, until they are released");
  command->add_option("POINT..LUX", held, "names (* and ? for several), then the goal in lux")->required();
  command->add_option("--for", held_for, "for how long: 90s, 10min, 2h (else until luxrig release)");
  add_client(*command, client);
  command->callback([&] { code = run_goal(client, held, held_for); });

  command = app.add_subcommand("release", "what was set by hand goes back to the plan");
  command->add_option("NAME", held, "fixtures and points (* and ? for several), or all")->required();
  add_client(*command, client);
  command->callback([&] { code = run_release(client, held); });

  bool undo_bypass = false;
  command = app.add_subcommand("bypass", "do without a fixture or luxmeter that has failed, with the risk said");
  command->add_option("NAME", held, "fixtures and luxmeters (* and ? for several)")->required();
  command->add_flag("--undo", undo_bypass, "it is mended: take it back");
  add_client(*command, client);
  command->callback([&] { code = run_bypass(client, held, undo_bypass); });

  command = app.add_subcommand("reload", "have the running daemon read its rig file again, whole or not at all");
  add_client(*command, client);
  command->callback([&] { code = run_reload(client); });

  std::vector<std::string> rested;
  command = app.add_subcommand("park", "heads go dark and to where they rest, until the next apply");
  command->add_option("FIXTURE", rested, "these heads (else all that have a place to rest)");
  add_client(*command, client);
  command->callback([&] { code = run_park(client, rested); });

  std::string identified;
  double identify_s = 5;
  command = app.add_subcommand("identify", "which one is it? a fixture blinks, or a head nods, and is then as it was");
  command->add_option("FIXTURE", identified, "its name in the rig file")->required();
  command->add_option("--seconds", identify_s, "for how long")->check(CLI::Range(0.5, 60.0));
  add_client(*command, client);
  command->callback([&] { code = run_identify(client, identified, identify_s); });

  bool monitor_once = false;
  command = app.add_subcommand("monitor", "universes, heads, dimmers and meters, live in the terminal");
  command->add_flag("--once", monitor_once, "one picture, then end");
  add_client(*command, client, false);
  command->callback([&] { code = run_monitor(client, monitor_once); });

  BenchOptions bench;
  std::string suite;
  command = app.add_subcommand("bench", "run time against error, on a named suite");
  command->add_option("SUITE", suite, "which")->required()->check(one_of(bench_suites()));
  command->add_flag("--quick", bench.quick, "under a minute, same columns");
  command->add_option("--csv", bench.csv_file, "write the rows here");
  command->add_option("--plot", bench.plot_file, "draw error over time here (PNG)");
  command->add_option("--threads", bench.threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
  command->add_option("--references", bench.references_folder, "transport: keep converged references in this folder");
  command->add_option("--reference-error", bench.reference_error, "transport: standard error of those")
      ->check(CLI::Range(1e-5, 0.1));
  command->add_option("--export", bench.export_folder,
                      "transport: write the rooms here for Radiance, measure nothing; nnls: the problems; highlight: "
                      "its made-up objects");
  command->add_option("--rig", bench.rigs, "transport: measure this rig's scene too");
  command->add_option("--method", bench.method, "placement and transport: only this method on scenes");
  command
      ->add_option("--seeds", bench.seeds,
                   "placement: rooms of each scene (default 100; for curves 20); faults: cases of each kind")
      ->check(CLI::Range(1, 10000));
  command
      ->add_option("--first-seed", bench.first_seed,
                   "placement: the first of those rooms, so that a long run can be split")
      ->check(CLI::Range(1, 10000));
  command->add_flag("!--no-bounds", bench.bounds, "placement: without certified bounds");
  command->add_option("--seconds", bench.seconds, "buses: how long each load runs")->check(CLI::Range(1.0, 86400.0));
  command->add_option("--data", bench.data_folder,
                      "folder of files; placement: office-scan.obj (tools/bench/data), apartment.glb; highlight: "
                      "venus-bust.glb, skull.obj, teapot.glb, egyptian-cat.glb, chess-board.glb");
  command->add_option("--only", bench.only, "only cases (analytic: families) whose name begins so");
  command->callback([&] { code = run_bench(suite, bench); });

  group(app, "Make a rig", {"init", "check", "import"});
  group(app, "Work out its light", {"evaluate", "solve", "render"});
  group(app, "Run it",
        {"run", "page", "status", "apply", "level", "goal", "release", "bypass", "reload", "blackout", "hand-back", "park",
         "identify", "monitor"});
  group(app, "Devices", {"devices", "rdm", "camera"});
  group(app, "Luxrig itself", {"bench"});
  const auto end = parse_command_line(app, argc, argv);
  return end ? *end : code;
}
