// luxrig-sim as a user starts it, over plain sockets.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>

#include "tests/tools/programs/process.h"
#include "tools/http/client.h"

namespace luxrig::testing {
namespace {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

class Simulator {
 public:
  explicit Simulator(std::filesystem::path ports_file, std::filesystem::path log)
      : process_({program("luxrig-sim"), source("tests/rigs/room"), "--deviations", "none", "--max-error", "0.2",
                  "--ports-file", ports_file.string()},
                 std::move(log)) {
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
  Process process_;
  json ports_;
};

// A socket connected to a loopback port.
class Client {
 public:
  Client(int type, int port) : fd_(::socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
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
