// The HTTP server against hostile peers, over real sockets.
#include "tools/http/server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "tests/tools/http/wire.h"
#include "tools/http/client.h"

namespace luxrig {
namespace {

/// Bound for an answer that waits for no peer.
constexpr std::chrono::milliseconds kAtOnce(100);
/// Bound for an answer whose time is not measured. The server works at low priority: beside busy processes it gets a
/// twentieth of a core, where a large body took 4 s under ThreadSanitizer.
constexpr std::chrono::seconds kAnswered(60);

/// Time for which this process's threads were ready to run while other work had the cores: proc(5), schedstat.
std::chrono::nanoseconds kept_off_the_cores() {
  std::int64_t all_ns = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::int64_t ran_ns = 0, kept_off_ns = 0;
    std::ifstream(task.path() / "schedstat") >> ran_ns >> kept_off_ns;
    all_ns += kept_off_ns;
  }
  return std::chrono::nanoseconds(all_ns);
}

/// Time since its construction that this process spent itself, working or asleep. Waiting for a peer counts in full;
/// time taken by other processes does not.
class OwnTime {
 public:
  [[nodiscard]] std::chrono::nanoseconds passed() const {
    const auto all = std::chrono::steady_clock::now() - start_;
    return all - (kept_off_the_cores() - kept_off_);
  }

 private:
  std::chrono::nanoseconds kept_off_ = kept_off_the_cores();
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

using namespace std::chrono_literals;
using test::status_of;
using test::Wire;
using SteadyClock = std::chrono::steady_clock;

const std::string kOk = "GET /looked HTTP/1.1\r\nHost: localhost\r\n";
constexpr const char* kJsonHead = "Host: localhost\r\nContent-Type: application/json\r\n";

std::string post(const std::string& path, const std::string& body, const std::string& headers = kJsonHead) {
  return "POST " + path + " HTTP/1.1\r\n" + headers + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
         body;
}

HttpRoute stream_of(const std::string& event) {
  return {"GET", "/events", [event](const HttpRequest&) { return HttpResponse{200, "text/event-stream", event}; },
          0,     false,     1,
          true};
}

class ServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    HttpServerOptions options;
    options.routes = {
        {"GET", "/looked",
         [this](const HttpRequest&) {
           ++looked;
           return HttpResponse{200, "text/plain", "seen"};
         }},
        {"GET", "/slow",
         [this](const HttpRequest&) {
           ++slow_ones;
           while (!released) std::this_thread::sleep_for(1ms);
           return HttpResponse{200, "text/plain", "late"};
         }},
        {"POST", "/changed",
         [this](const HttpRequest& request) {
           ++changed;
           last_body = request.body;
           return HttpResponse{};
         }},
        {"POST", "/throws", [](const HttpRequest&) -> HttpResponse { throw std::runtime_error("a bug"); }},
        {"POST", "/large",
         [this](const HttpRequest& request) {
           large_bytes = request.body.size();
           return HttpResponse{};
         },
         1u << 20},
        {"POST", "/urgent",
         [this](const HttpRequest&) {
           ++urgent;
           return HttpResponse{};
         },
         1024, true},
        stream_of("event: status\ndata: {}\n\n"),
    };
    server = std::make_unique<HttpServer>(std::move(options));
    const auto bound = server->bind(0);
    ASSERT_TRUE(bound);
    port = *bound;
    server->start();
  }
  void TearDown() override { released = true; }

  [[nodiscard]] int status(const std::string& request) const {
    Wire wire(port);
    wire.send(request);
    return status_of(wire.receive(kAnswered, "\r\n\r\n"));
  }

  std::atomic<int> looked{0}, changed{0}, urgent{0}, slow_ones{0};
  std::atomic<std::size_t> large_bytes{0};
  std::atomic<bool> released{false};
  std::string last_body;
  std::unique_ptr<HttpServer> server;
  int port = 0;
};

TEST_F(ServerTest, KeepsAConnectionForTheNextRequest) {
  Wire wire(port);
  for (int i = 0; i < 3; ++i) {
    wire.send(kOk + "\r\n");
    EXPECT_NE(wire.receive(kAnswered, "seen").find("seen"), std::string::npos) << i;
  }
  wire.send(post("/changed", "{\"a\":1}"));
  EXPECT_EQ(status_of(wire.receive(kAnswered, "\r\n\r\n")), 200);
  EXPECT_EQ(last_body, "{\"a\":1}");
  wire.send(kOk + "Connection: close\r\n\r\n");
  EXPECT_NE(wire.receive(kAnswered).find("seen"), std::string::npos);
  EXPECT_TRUE(wire.ended());
}

TEST_F(ServerTest, IgnoresDataAfterARefusedRequest) {
  const std::string smuggled = post("/changed", "{}");
  for (const std::string& foreign :
       {std::string("Origin: http://evil.example\r\n"), std::string("Origin: null\r\n"),
        std::string("Origin: http://localhost:81\r\n"), std::string("Sec-Fetch-Site: cross-site\r\n"),
        std::string("Sec-Fetch-Site: same-site\r\n"), std::string("Host: localhost\r\n")}) {
    for (const std::string& type : {std::string("text/plain"), std::string("application/json")}) {
      Wire wire(port);
      wire.send("POST /changed HTTP/1.1\r\nHost: localhost\r\n" + foreign + "Content-Type: " + type +
                "\r\nContent-Length: " + std::to_string(smuggled.size()) + "\r\n\r\n" + smuggled);
      const std::string answer = wire.receive(kAnswered);
      EXPECT_EQ(status_of(answer), 403) << foreign << answer;
      EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos) << "one answer only: " << answer;
      EXPECT_NE(answer.find("Connection: close"), std::string::npos);
      EXPECT_TRUE(wire.ended());
    }
  }
  // The same for other refusals: of a route, method, type or length, and of bytes that are not HTTP.
  for (const std::string& first :
       {post("/none", smuggled), "PUT" + post("/changed", smuggled).substr(4), std::string("\x16\x03\x01\x02\r\n\r\n"),
        post("/changed", smuggled, "Host: localhost\r\nContent-Type: text/plain\r\n"),
        "POST /changed HTTP/1.1\r\n" + std::string(kJsonHead) + "Content-Length: 99999999\r\n\r\n",
        "POST /changed HTTP/1.1\r\n" + std::string(kJsonHead) +
            "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        "POST /changed HTTP/1.1\r\n" + std::string(kJsonHead) + "Content-Length: 5\r\nContent-Length: 6\r\n\r\n"}) {
    Wire wire(port);
    wire.send(first + smuggled);
    const std::string answer = wire.receive(kAnswered);
    EXPECT_GE(status_of(answer), 400) << first;
    EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos) << first << answer;
    EXPECT_TRUE(wire.ended());
  }
  EXPECT_EQ(changed, 0);
  // The same after an accepted request: it is answered, and the connection ends.
  Wire wire(port);
  wire.send(post("/changed", "{}") + smuggled);
  EXPECT_EQ(status_of(wire.receive(kAnswered)), 200);
  EXPECT_TRUE(wire.ended());
  EXPECT_EQ(changed, 1);
}

TEST_F(ServerTest, HostMustBeLoopback) {
  for (const char* host : {"localhost", "127.0.0.1", "127.0.0.1:81", "[::1]:9620", "LOCALHOST:1"})
    EXPECT_EQ(status(std::string("GET /looked HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), 200) << host;
  looked = 0;
  for (const char* host : {"evil.example", "localhost.evil.example", "127.0.0.1.nip.io", "localhost:", "localhost:x",
                           "localhost:123456", "", "127.0.0.2", "localhost@evil.example"})
    EXPECT_EQ(status(std::string("GET /looked HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), 403) << host;
  EXPECT_EQ(status("GET /looked HTTP/1.1\r\n\r\n"), 403) << "no Host";
  EXPECT_EQ(status(kOk + "Host: localhost\r\n\r\n"), 403) << "two";
  EXPECT_EQ(status(kOk + "Origin: http://evil.example\r\n\r\n"), 403) << "a GET, too";
  EXPECT_EQ(status("GET /events HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost:81\r\n\r\n"), 403);
  EXPECT_EQ(looked, 0);
  EXPECT_EQ(status(kOk + "Origin: http://localhost\r\nSec-Fetch-Site: same-origin\r\n\r\n"), 200);
}

TEST_F(ServerTest, HeadersAndBodiesHaveLimits) {
  EXPECT_EQ(status(kOk + "X: " + std::string(8000, 'x') + "\r\n\r\n"), 200);
  EXPECT_EQ(status(kOk + "X: " + std::string(9000, 'x') + "\r\n\r\n"), 431);
  EXPECT_EQ(status("GET /" + std::string(9000, 'x') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"), 431);
  EXPECT_EQ(status("GET /" + std::string(1 << 20, 'x')), 431);
  std::string many = kOk;
  for (int i = 0; i < 100; ++i) many += "a: b\r\n";
  EXPECT_EQ(status(many + "\r\n"), 431);

  EXPECT_EQ(status(post("/changed", std::string(16384, ' '))), 200);
  EXPECT_EQ(status(post("/changed", std::string(16385, ' '))), 413);
  EXPECT_EQ(status(post("/looked", " ")), 405);
  const std::string chunked =
      "POST /changed HTTP/1.1\r\n" + std::string(kJsonHead) + "Transfer-Encoding: chunked\r\n\r\n";
  changed = 0;
  EXPECT_EQ(status(chunked + "2\r\n{}\r\n0\r\n\r\n"), 200);
  EXPECT_EQ(last_body, "{}");
  std::string chunks;
  for (int i = 0; i < 17; ++i) chunks += "400\r\n" + std::string(1024, ' ') + "\r\n";
  EXPECT_EQ(status(chunked + chunks + "0\r\n\r\n"), 413);
  EXPECT_EQ(status(chunked + "ffffffffffffffff\r\n"), 413);
  EXPECT_EQ(status(chunked + "1;x=" + std::string(20000, 'x')), 431) << "a chunk's extension";
  EXPECT_EQ(status(chunked + "0\r\nx: " + std::string(20000, 'x')), 431) << "a trailer";
  EXPECT_EQ(changed, 1);
}

TEST_F(ServerTest, AcceptsLargeBodiesWholeButOnlyTwoAtOnce) {
  const std::string body(1 << 20, 'x');
  EXPECT_EQ(status(post("/large", body)), 200);
  EXPECT_EQ(large_bytes, body.size());
  const std::string whole = post("/large", body, std::string(kJsonHead) + "Expect: 100-continue\r\n");
  const std::string head = whole.substr(0, whole.size() - body.size());
  std::vector<Wire> begun;
  for (int i = 0; i < 2; ++i) {
    begun.emplace_back(port).send(head);
    EXPECT_EQ(status_of(begun.back().receive(kAnswered, "\r\n\r\n")), 100) << i;
  }
  EXPECT_EQ(status(head), 503);
  EXPECT_EQ(status(post("/large", "{}")), 200) << "a short body is none, whatever its route takes";
  begun.clear();
  const auto end = SteadyClock::now() + kAnswered;
  int again = 503;
  while (again == 503 && SteadyClock::now() < end) again = status(post("/large", body));
  EXPECT_EQ(again, 200) << "whoever went makes room";
}

TEST_F(ServerTest, SupportsExpectContinue) {
  Wire wire(port);
  const std::string request = post("/changed", "{}", std::string(kJsonHead) + "Expect: 100-continue\r\n");
  wire.send(request.substr(0, request.size() - 2));
  EXPECT_EQ(status_of(wire.receive(kAnswered, "\r\n\r\n")), 100);
  wire.send("{}");
  EXPECT_EQ(status_of(wire.receive(kAnswered, "\r\n\r\n")), 200);
}

TEST_F(ServerTest, TwoHundredSlowClientsLockNoOtherOut) {
  std::vector<Wire> dribbling;
  for (int i = 0; i < 200; ++i) dribbling.emplace_back(port).send("GET /loo");
  for (int round = 0; round < 5; ++round) {
    for (Wire& wire : dribbling) wire.send("k");
    const OwnTime own;
    EXPECT_EQ(status(post("/urgent", "{}")), 200) << round;
    EXPECT_LT(own.passed(), kAtOnce) << round;
  }
  EXPECT_EQ(urgent, 5);
}

TEST_F(ServerTest, UrgentRequestsDoNotWait) {
  std::vector<Wire> waiting;
  for (int i = 0; i < 20; ++i) waiting.emplace_back(port).send("GET /slow HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const auto end = SteadyClock::now() + kAnswered;
  while (slow_ones == 0 && SteadyClock::now() < end) std::this_thread::sleep_for(1ms);
  ASSERT_GT(slow_ones, 0);
  const OwnTime own;
  EXPECT_EQ(status(post("/urgent", "{}")), 200);
  EXPECT_LT(own.passed(), kAtOnce);
  EXPECT_LT(slow_ones, 20) << "few threads, many that wait";
  released = true;
  EXPECT_EQ(status_of(waiting.back().receive(kAnswered, "late")), 200);
}

TEST_F(ServerTest, OnePeerDoesNotGetAllEventStreams) {
  std::vector<Wire> streams;
  int good = 0;
  for (int i = 0; i < 16; ++i) {
    streams.emplace_back(port).send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    if (status_of(streams.back().receive(kAnswered, "data: {}\n\n")) == 200) ++good;
  }
  EXPECT_EQ(good, 8);
  EXPECT_NE(streams[0].receive(kAnswered, "data: {}\n\n").find("event: status"), std::string::npos) << "they go on";
  streams.clear();
  const auto end = SteadyClock::now() + kAnswered;
  int again = 0;
  while (again != 200 && SteadyClock::now() < end) {
    std::this_thread::sleep_for(100ms);
    again = status("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  EXPECT_EQ(again, 200) << "whoever went makes room";
}

TEST_F(ServerTest, StopsRegardlessOfHangingClients) {
  std::vector<Wire> hung;
  for (int i = 0; i < 20; ++i) hung.emplace_back(port).send("GET /loo");
  for (int i = 0; i < 20; ++i)
    hung.emplace_back(port).send("POST /changed HTTP/1.1\r\n" + std::string(kJsonHead) + "Content-Length: 9\r\n\r\n{");
  for (int i = 0; i < 8; ++i) hung.emplace_back(port).send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::this_thread::sleep_for(300ms);
  const auto start = SteadyClock::now();
  server->stop();
  EXPECT_LT(SteadyClock::now() - start, 5 * kAtOnce);
  EXPECT_FALSE(Wire(port).connected());
  server->stop();
}

TEST_F(ServerTest, AThrowingHandlerIsAnsweredWith500) {
  EXPECT_EQ(status(post("/throws", "{}")), 500);
  EXPECT_EQ(status(kOk + "\r\n"), 200);
}

TEST_F(ServerTest, SlowRequestsTimeOut) {
  Wire wire(port);
  wire.send("GET /loo");
  const auto start = SteadyClock::now();
  std::string got;
  for (int i = 0; i < 80 && !wire.ended(); ++i) {
    got += wire.receive(100ms);
    wire.send("k");  // an occasional byte does not keep it open
  }
  EXPECT_TRUE(wire.ended());
  EXPECT_LT(SteadyClock::now() - start, 5s + 10 * kAtOnce);
  EXPECT_GT(SteadyClock::now() - start, 4s);
}

TEST_F(ServerTest, ItsOwnClientWorks) {
  const auto looked_at = http_get({"127.0.0.1", port}, "/looked");
  ASSERT_TRUE(looked_at);
  EXPECT_EQ(looked_at->body, "seen");
  const auto done = http_post_json({"localhost", port}, "/changed", "{}");
  ASSERT_TRUE(done);
  EXPECT_EQ(done->status, 200);
  const auto refused = http_post_json({"localhost", port}, "/changed", std::string(1 << 24, 'x'));
  ASSERT_TRUE(refused) << "the answer is heard, although the body was not";
  EXPECT_EQ(refused->status, 413);
  server->stop();
  EXPECT_FALSE(http_get({"127.0.0.1", port}, "/looked"));
}

TEST(HttpServer, RequiresACredentialOnItsPortButNotOnItsUnixSocket) {
  const std::string file = "/tmp/luxrig-http-test-" + std::to_string(::getpid()) + ".socket";
  HttpServerOptions options;
  options.routes = {{"GET", "/who",
                     [](const HttpRequest& request) {
                       return HttpResponse{200, "text/plain", request.sender.credential};
                     }},
                    {"GET", "/open",
                     [](const HttpRequest& request) {
                       return HttpResponse{200, "text/plain", "for anybody" + request.sender.credential};
                     },
                     0, false, 0},
                    {"POST", "/done", [](const HttpRequest&) { return HttpResponse{}; }, 16u << 10, false, 2},
                    stream_of("data: 1\n\n")};
  options.page = [](const HttpRequest&) { return HttpResponse{200, "text/plain", "the page"}; };
  options.sender = [](const HttpRequest& request) {
    const auto given = request.header("authorization");
    return given == "Bearer right"  ? HttpSender{"known", "anna", 1}
           : given == "Bearer more" ? HttpSender{"more", "otto", 2}
                                    : HttpSender{};
  };
  HttpServer server(std::move(options));
  const auto port = server.bind(0);
  ASSERT_TRUE(port);
  ASSERT_TRUE(server.bind_socket(file));
  server.start();
  HttpPeer peer{"127.0.0.1", *port};
  EXPECT_EQ(http_get(peer, "/who")->status, 401);
  EXPECT_EQ(http_get(peer, "/events")->status, 401);
  EXPECT_EQ(http_get(peer, "/")->body, "the page");
  EXPECT_EQ(http_get(peer, "/open")->body, "for anybody");
  EXPECT_EQ(http_post_json(peer, "/open", "{}")->status, 405);
  peer.token = "wrong";
  EXPECT_EQ(http_get(peer, "/who")->status, 401);
  peer.token = "right";
  EXPECT_EQ(http_get(peer, "/who")->body, "known");
  EXPECT_EQ(http_post_json(peer, "/done", "{}")->status, 403) << "known, but of too low a rank";
  peer.token = "more";
  EXPECT_EQ(http_post_json(peer, "/done", "{}")->status, 200);
  HttpPeer by_socket{"", 0, file};
  EXPECT_TRUE(http_listens(file));
  EXPECT_EQ(http_get(by_socket, "/who")->body, "socket");
  server.stop();
  EXPECT_FALSE(http_listens(file));
}

TEST(HttpServer, AStreamEndsWithTheAccessOfItsReader) {
  std::atomic<bool> may{true};
  HttpServerOptions options;
  options.routes = {stream_of("data: 1\n\n")};
  options.sender = [](const HttpRequest&) { return HttpSender{"anna", "anna", 1}; };
  options.still = [&](const HttpSender& sender) { return sender.credential == "anna" && may; };
  HttpServer server(std::move(options));
  const auto port = server.bind(0);
  ASSERT_TRUE(port);
  server.start();
  Wire wire(*port);
  ASSERT_TRUE(wire.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  EXPECT_NE(wire.receive(kAnswered, "data: 1\n\n").find("data: 1"), std::string::npos);
  may = false;
  (void)wire.receive(kAnswered);
  EXPECT_TRUE(wire.ended());
}

TEST(HttpServer, SlowRequestsRunOneByOneAndAFewWait) {
  std::atomic<int> running{0}, most{0}, done{0};
  std::atomic<bool> go_on{false};
  HttpServerOptions options;
  options.routes = {{"POST", "/slow",
                     [&](const HttpRequest&) {
                       most = std::max<int>(most, ++running);
                       while (!go_on) std::this_thread::yield();
                       --running;
                       ++done;
                       return HttpResponse{};
                     },
                     1024, false, 1, false, true},
                    {"POST", "/quick", [](const HttpRequest&) { return HttpResponse{}; }}};
  HttpServer server(std::move(options));
  const auto port = server.bind(0);
  ASSERT_TRUE(port);
  server.start();
  std::vector<Wire> wires;
  for (int i = 0; i < 4; ++i) {
    wires.emplace_back(*port);
    ASSERT_TRUE(wires.back().send(post("/slow", "{}")));
  }
  // Until the server has come to all four, the fifth could be one of them.
  std::string fifth;
  for (bool refused = false; !refused;) {
    Wire wire(*port);
    ASSERT_TRUE(wire.send(post("/slow", "{}")));
    fifth = wire.receive(100ms, "\r\n\r\n");
    refused = !fifth.empty();
  }
  EXPECT_EQ(status_of(fifth), 503) << fifth;
  EXPECT_EQ(http_post_json({"127.0.0.1", *port}, "/quick", "{}")->status, 200) << "others need not wait";
  go_on = true;
  for (Wire& wire : wires) EXPECT_EQ(status_of(wire.receive(kAnswered, "\r\n\r\n")), 200);
  EXPECT_EQ(most, 1);
}

}  // namespace
}  // namespace luxrig
