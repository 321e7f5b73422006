// luxrig-sim as a user starts it, over plain sockets.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/tools/programs/process.h"
#include "tools/http/client.h"

namespace luxrig::testing {
namespace {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

class Simulator {
 public:
  explicit Simulator(std::filesystem::path ports_file, std::filesystem::path log,
                     const std::vector<std::string>& options = {}, const std::string& rig = "tests/rigs/room")
      : process_(words(rig, ports_file, options), std::move(log)) {
    const bool ready = wait_for([&] { return ready_line().has_value(); }, 60s);
    EXPECT_TRUE(ready) << process_.output();
    if (ready) ports_ = json::parse(*ready_line(), nullptr, false);
  }

  /// The rest of the line after the word.
  std::optional<std::string> ready_line() const {
    const std::string output = process_.output();
    const auto at = output.find("ready ");
    const auto end = at == std::string::npos ? at : output.find('\n', at);
    if (end == std::string::npos) return std::nullopt;
    return output.substr(at + 6, end - at - 6);
  }
  [[nodiscard]] const json& ports() const { return ports_; }
  [[nodiscard]] int port(const std::string& bus) const { return ports_["buses"][bus]["port"]; }
  [[nodiscard]] json get(const std::string& route) const {
    const auto answer = http_get({"127.0.0.1", ports_["control"]["port"]}, route);
    return answer ? json::parse(answer->body, nullptr, false) : json();
  }
  [[nodiscard]] HttpAnswer post(const std::string& route, const std::string& body) const {
    return http_post_json({"127.0.0.1", ports_["control"]["port"]}, route, body).value_or(HttpAnswer{});
  }
  [[nodiscard]] json point(const std::string& name) const {
    const json truth = get("/truth");
    for (const json& each : truth.value("points", json::array())) {
      if (each["name"] == name) return each;
    }
    return {};
  }
  Process& process() { return process_; }

 private:
  static std::vector<std::string> words(const std::string& rig, const std::filesystem::path& ports_file,
                                        const std::vector<std::string>& options) {
    std::vector<std::string> words = {program("luxrig-sim"), source(rig), "--deviations", "none",
                                      "--max-error",         "0.2",       "--ports-file", ports_file.string()};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  Process process_;
  json ports_;
};

// A socket connected to a port of a loopback address.
class Client {
 public:
  Client(int type, int port, const std::string& host = "127.0.0.1") : fd_(::socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    ::inet_pton(AF_INET, host.c_str(), &to.sin_addr);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const Bytes& bytes) const { ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  Bytes received(int wait_ms) const {
    pollfd readable{fd_, POLLIN, 0};
    if (::poll(&readable, 1, wait_ms) <= 0) return {};
    Bytes bytes(512);
    const auto size = ::recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }

 private:
  int fd_;
};

// ANSI E1.31 data packet for universe 1: spot-1 (address 1) full, everything else dark. 138 bytes.
Bytes spot_full() {
  Bytes packet = {
      0x00, 0x10, 0x00, 0x00,                                                       // preamble, postamble
      'A',  'S',  'C',  '-',  'E', '1', '.', '1', '7', 0,  0,  0,                   // ACN packet identifier
      0x70, 0x7a, 0,    0,    0,   4,                                               // root: 138 - 16; vector: data
      1,    2,    3,    4,    5,   6,   7,   8,   9,   10, 11, 12, 13, 14, 15, 16,  // CID
      0x70, 0x64, 0,    0,    0,   2,  // framing: 138 - 38; vector: data packet
      't',  'e',  's',  't'            // source name, 64 bytes
  };
  packet.resize(108, 0);
  const Bytes rest = {
      100,  0,    0,                                // priority, no synchronisation
      0,    0,    0, 1,                             // sequence, options, universe
      0x70, 0x17, 2, 0xa1, 0, 0, 0, 1, 0, 13,       // DMP: 138 - 115; 13 values from 0
      0,                                            // start code
      255,  0,    0, 0,    0, 0, 0, 0, 0, 0,  0, 0  // slots 1 to 12
  };
  packet.insert(packet.end(), rest.begin(), rest.end());
  return packet;
}

TEST(SimProcess, ReportsItsPortsAndReusesThemAfterSigterm) {
  const Folder folder;
  json first;
  {
    Simulator sim(folder / "ports.json", folder / "first.log");
    first = sim.ports();
    ASSERT_TRUE(first.is_object() && first.contains("buses"));
    EXPECT_EQ(json::parse(text_of(folder / "ports.json"), nullptr, false), first);
    EXPECT_EQ(first["buses"].size(), 2u);
    EXPECT_TRUE(sim.get("/truth").is_object());
    sim.process().signal(SIGTERM);
    EXPECT_EQ(sim.process().wait(2s), 0) << sim.process().output();
  }
  Simulator again(folder / "ports.json", folder / "again.log");
  EXPECT_EQ(again.ports(), first);
  EXPECT_TRUE(again.get("/truth").is_object());
}

TEST(SimProcess, AnswersPlainSocketsAsTheDevicesWould) {
  const Folder folder;
  Simulator sim(folder / "ports.json", folder / "log");
  ASSERT_TRUE(sim.ports().is_object());
  EXPECT_EQ(sim.point("plinth-top").value("lux", -1.0), 0);

  const Client desk(SOCK_DGRAM, sim.port("dmx"));
  desk.send(spot_full());
  ASSERT_TRUE(wait_for([&] { return sim.point("plinth-top").value("lux", 0.0) > 50; }, 2s)) << sim.get("/truth");

  // Meter 1 stands on the plinth, measures five times a second and has 0.001 lx per count, high word first.
  const Client master(SOCK_STREAM, sim.port("field"));
  const double lux = sim.point("plinth-top")["lux"];
  double read_lx = 0;
  EXPECT_TRUE(wait_for(
      [&] {
        master.send({0x00, 0x07, 0, 0, 0, 6, 1, 3, 0x00, 0x02, 0x00, 0x02});
        const Bytes answer = master.received(1000);
        if (answer.size() != 13) return false;
        EXPECT_EQ(Bytes(answer.begin(), answer.begin() + 9), (Bytes{0x00, 0x07, 0, 0, 0, 7, 1, 3, 4}));
        read_lx = 0.001 * (answer[9] * 16777216.0 + answer[10] * 65536.0 + answer[11] * 256.0 + answer[12]);
        return std::abs(read_lx - lux) < 0.01 * lux;
      },
      2s))
      << read_lx << " lx read, " << lux << " lx true";
}

TEST(SimProcess, SwitchesFaultsAndResetsPeaksOnRequest) {
  const Folder folder;
  Simulator sim(folder / "ports.json", folder / "log");
  ASSERT_TRUE(sim.ports().is_object());

  const HttpAnswer unknown = sim.post("/fault", R"({"device":"meter-1","fault":"tired","on":true})");
  EXPECT_EQ(unknown.status, 400);
  EXPECT_NE(unknown.body.find("use one of"), std::string::npos) << unknown.body;
  EXPECT_EQ(sim.post("/fault", R"({"device":"nobody","fault":"silent","on":true})").status, 400);
  EXPECT_EQ(sim.post("/fault", R"({"device":"meter-1","fault":"lost","on":true,"value":2})").status, 400);
  for (const char* body : {"", "[]", "{", R"({"device":1,"fault":"silent","on":true})", R"({"device":"meter-1"})"}) {
    EXPECT_EQ(sim.post("/fault", body).status, 400) << body;
  }

  const Client master(SOCK_STREAM, sim.port("field"));
  const Bytes read = {0, 1, 0, 0, 0, 6, 1, 3, 0, 2, 0, 2};
  EXPECT_EQ(sim.post("/fault", R"({"device":"meter-1","fault":"exception","on":true,"value":6})").status, 200);
  master.send(read);
  EXPECT_EQ(master.received(1000), (Bytes{0, 1, 0, 0, 0, 3, 1, 0x83, 6}));
  EXPECT_EQ(sim.post("/clear_faults", "").status, 200);
  master.send(read);
  EXPECT_EQ(master.received(1000).size(), 13u);

  // The bulb on and off again over Modbus: the peak stays until it is reset.
  master.send({0, 2, 0, 0, 0, 6, 10, 6, 0, 0, 0x03, 0xe8});
  EXPECT_EQ(master.received(1000).size(), 12u);
  ASSERT_TRUE(wait_for([&] { return sim.point("floor").value("lux", 0.0) > 1; }, 2s));
  master.send({0, 3, 0, 0, 0, 6, 10, 6, 0, 0, 0, 0});
  EXPECT_EQ(master.received(1000).size(), 12u);
  ASSERT_TRUE(wait_for([&] { return sim.point("floor").value("lux", 1.0) == 0; }, 2s));
  EXPECT_GT(sim.point("floor").value("max_lux_seen", 0.0), 1);
  EXPECT_EQ(sim.post("/reset_peaks", "").status, 200);
  EXPECT_EQ(sim.point("floor").value("max_lux_seen", -1.0), 0);
}

TEST(SimProcess, WhatStandsInTheLightIsSetAndToldAndWrongInputIsRefused) {
  const Folder folder;
  Simulator sim(folder / "ports.json", folder / "log");
  ASSERT_TRUE(sim.ports().is_object());
  const Client desk(SOCK_DGRAM, sim.port("dmx"));
  desk.send(spot_full());
  ASSERT_TRUE(wait_for([&] { return sim.point("plinth-top").value("lux", 0.0) > 50; }, 5s));
  const auto settled_lux = [&] {
    double last = -1;
    EXPECT_TRUE(wait_for(
        [&] {
          const double lux = sim.point("plinth-top").value("lux", 0.0);
          return std::abs(std::exchange(last, lux) - lux) < 1e-6 * lux;
        },
        5s));
    return last;
  };
  const double open_lux = settled_lux();
  EXPECT_EQ(sim.post("/shade", R"({"point":"plinth-top","value":0.25})").status, 200);
  EXPECT_TRUE(wait_for(
      [&] { return std::abs(sim.point("plinth-top").value("lux", 0.0) - 0.25 * open_lux) < 0.01 * open_lux; }, 5s));
  EXPECT_EQ(sim.point("plinth-top").value("shade", 1.0), 0.25);
  EXPECT_EQ(sim.post("/shade", R"({"point":"plinth-top","value":1})").status, 200);
  EXPECT_FALSE(sim.point("plinth-top").contains("shade"));
  EXPECT_EQ(sim.post("/cover", R"({"luxmeter":"meter-1","value":0})").status, 200);
  EXPECT_TRUE(wait_for([&] { return sim.get("/truth")["luxmeters"][0].value("shown", 1.0) == 0; }, 5s));
  EXPECT_EQ(sim.get("/truth")["luxmeters"][0].value("cover", 1.0), 0);

  const auto refused = [&](const char* route, const char* body, const char* because) {
    const HttpAnswer answer = sim.post(route, body);
    EXPECT_EQ(answer.status, 400) << route << ' ' << body;
    EXPECT_NE(answer.body.find(because), std::string::npos) << body << ": " << answer.body;
  };
  refused("/shade", R"({"point":"plint-top","value":0.5})", R"(did you mean \"plinth-top\"?)");
  refused("/shade", R"({"point":"plinth-top","value":1.5})", "is out of range: use 0");
  refused("/shade", R"({"point":"plinth-top","value":-0.1})", "is out of range: use 0");
  refused("/shade", R"({"point":"plinth-top"})", "send {");
  refused("/shade", R"({"point":1,"value":0.5})", "send {");
  refused("/shade", R"({"luxmeter":"meter-1","value":0.5})", R"(unknown key \"luxmeter\")");
  refused("/cover", R"({"luxmeter":"meter-9","value":0.5})", "the rig has no luxmeter");
  refused("/cover", "[]", "send {");
  refused("/daylight", R"({"value":2})", "add [daylight] to the rig file");
  refused("/daylight", R"({"value":"2"})", "send {");

  EXPECT_EQ(sim.post("/fault", R"({"device":"meter-1","fault":"slow","on":true,"value":20})").status, 200);
  const json on = {{"device", "meter-1"}, {"fault", "slow"}, {"value", 20}};
  EXPECT_EQ(sim.get("/truth")["faults"], json::array({on}));
}

TEST(SimProcess, DaylightIsMultiplied) {
  const Folder folder;
  Simulator sim(folder / "ports.json", folder / "log", {}, "rigs/reading-room");
  ASSERT_TRUE(sim.ports().is_object());
  const json points = sim.get("/truth")["points"];
  ASSERT_FALSE(points.empty());
  const double before_lux = points[0]["lux"];
  ASSERT_GT(before_lux, 0);
  EXPECT_EQ(sim.get("/truth")["daylight"], 1);
  EXPECT_EQ(sim.post("/daylight", R"({"value":2})").status, 200);
  EXPECT_TRUE(wait_for(
      [&] { return std::abs(sim.get("/truth")["points"][0].value("lux", 0.0) - 2 * before_lux) < 1e-6 * before_lux; },
      5s));
  EXPECT_EQ(sim.get("/truth")["daylight"], 2);
  EXPECT_EQ(sim.post("/daylight", R"({"value":1001})").status, 400);
}

TEST(SimProcess, ServesItsPageAndSaysWhereEverythingListens) {
  const Folder folder;
  Simulator sim(folder / "ports.json", folder / "log");
  ASSERT_TRUE(sim.ports().is_object());
  const int control = sim.ports()["control"]["port"];
  const auto header_of = [&](const std::string& path) {
    return run({"/bin/bash", "-c",
                "exec 3<>/dev/tcp/127.0.0.1/$1; printf 'GET %s HTTP/1.1\\r\\nHost: localhost\\r\\nConnection: "
                "close\\r\\n\\r\\n' \"$2\" >&3; timeout 5 cat <&3",
                "ask", std::to_string(control), path})
        .output;
  };
  for (const auto& [path, type] : {std::pair{"/", "text/html; charset=utf-8"}, std::pair{"/page.js", "text/javascript"},
                                   std::pair{"/page.css", "text/css"}}) {
    const std::string answer = header_of(path);
    EXPECT_NE(answer.find(" 200 "), std::string::npos) << answer.substr(0, 300);
    EXPECT_NE(answer.find(std::string("Content-Type: ") + type), std::string::npos) << answer.substr(0, 300);
    EXPECT_NE(answer.find("Content-Security-Policy: default-src 'self'"), std::string::npos) << answer.substr(0, 300);
  }
  EXPECT_NE(header_of("/truht").find("did you mean"), std::string::npos);

  const json rig = sim.get("/rig");
  ASSERT_TRUE(rig.is_object());
  EXPECT_EQ(rig["rig"], "room");
  EXPECT_EQ(rig["world"], "none, seed 1");
  EXPECT_EQ(rig["buses"][0]["protocol"], "sACN (E1.31)");
  EXPECT_EQ(rig["buses"][0]["port"], sim.port("dmx"));
  EXPECT_EQ(rig["buses"][0]["universes"], json::array({1}));
  EXPECT_FALSE(rig["buses"][0].contains("multicast")) << "only with --standard-ports";
  EXPECT_EQ(rig["buses"][1]["units"], json::array({1, 2, 10}));
  EXPECT_EQ(rig["fixtures"][2]["register"], 0);
  EXPECT_EQ(rig["fixtures"][2]["type"], "uint16");
  EXPECT_EQ(rig["luxmeters"][0]["register"], 2);
  EXPECT_EQ(rig["luxmeters"][0]["type"], "uint32");
  EXPECT_EQ(rig["cameras"], json::array({"door"}));
  EXPECT_EQ(rig["faults"].size(), 22u);
}

// A loopback address of this process only, so that the standard ports are free there.
std::string own_loopback_address() {
  const int pid = ::getpid();
  return "127.77." + std::to_string(pid >> 8 & 255) + '.' + std::to_string(std::clamp(pid & 255, 1, 254));
}

TEST(SimProcess, WithStandardPortsASpotIsLitAtTheAddressThatIsGiven) {
  const Folder folder;
  const std::string host = own_loopback_address();
  Simulator sim(folder / "ports.json", folder / "log", {"--standard-ports", "--listen", host});
  ASSERT_TRUE(sim.ports().is_object());
  EXPECT_EQ(sim.port("dmx"), 5568);
  EXPECT_EQ(sim.ports()["buses"]["dmx"]["host"], host);
  EXPECT_EQ(sim.ports()["control"]["host"], "127.0.0.1");
  const int modbus = sim.port("field");
  EXPECT_TRUE(modbus == 502 ||
              (modbus == 1502 && sim.process().output().find("CAP_NET_BIND_SERVICE") != std::string::npos))
      << sim.process().output();
  EXPECT_EQ(sim.get("/rig")["buses"][0]["multicast"], json::array({"239.255.0.1"}));
  const Client desk(SOCK_DGRAM, 5568, host);
  desk.send(spot_full());
  EXPECT_TRUE(wait_for([&] { return sim.point("plinth-top").value("lux", 0.0) > 50; }, 5s)) << sim.get("/truth");
  const Client master(SOCK_STREAM, modbus, host);
  master.send({0, 1, 0, 0, 0, 6, 1, 3, 0, 2, 0, 2});
  EXPECT_EQ(master.received(5000).size(), 13u);

  const Ran second = run(
      {program("luxrig-sim"), source("tests/rigs/room"), "--max-error", "0.2", "--standard-ports", "--listen", host});
  EXPECT_EQ(second.code, 1);
  EXPECT_NE(second.output.find("another luxrig-sim listens on " + host + " port 5568"), std::string::npos)
      << second.output;
}

TEST(SimProcess, RefusesAnAddressThatIsNotThisComputers) {
  const Ran word = run({program("luxrig-sim"), source("tests/rigs/room"), "--listen", "everywhere"});
  EXPECT_EQ(word.code, 2);
  EXPECT_NE(word.output.find("\"everywhere\" is no IPv4 address: give one of this computer"), std::string::npos)
      << word.output;
  const Ran other =
      run({program("luxrig-sim"), source("tests/rigs/room"), "--max-error", "0.2", "--listen", "192.0.2.1"});
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.output.find("this computer has no such address"), std::string::npos) << other.output;
}

TEST(SimProcess, RefusesAnInvalidRigOrPortsFile) {
  const Folder folder;
  EXPECT_EQ(run({program("luxrig-sim"), (folder / "nowhere.toml").string()}).code, 2);
  std::ofstream(folder / "ports.json") << "not JSON";
  const Ran ran =
      run({program("luxrig-sim"), source("tests/rigs/room"), "--ports-file", (folder / "ports.json").string()});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.output.find("delete the file"), std::string::npos) << ran.output;
  EXPECT_EQ(run({program("luxrig-sim"), source("tests/rigs/room"), "--deviations", "nune"}).code, 2);
}

}  // namespace
}  // namespace luxrig::testing
