// The HTTP API against hostile and honest clients, over a real socket.
#include "tools/luxrigd/api/http_api.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include "core/plan/plan.h"
#include "tests/sanitized.h"
#include "tools/luxrigd/api/accounts.h"
#include "tools/luxrigd/api/preview_json.h"
#include "tools/process/meeting_place.h"
#include "tools/process/runtime_folder.h"

namespace luxrig {
namespace {

/// Token of the daemon under test; `post` and `get` send it.
std::string g_token;

/// Sends raw bytes; returns the answer.
std::string ask(int port, const std::string& request, bool wait_for_end = true) {
  const int client = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (::connect(client, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0) {
    (void)::send(client, request.data(), request.size(), MSG_NOSIGNAL);
    char buffer[4096];
    ssize_t n = 0;
    while ((n = ::recv(client, buffer, sizeof buffer, 0)) > 0) {
      answer.append(buffer, static_cast<std::size_t>(n));
      if (!wait_for_end) break;
    }
  }
  ::close(client);
  return answer;
}

std::string post(const std::string& route, const std::string& body, const std::string& headers) {
  return "POST " + route + " HTTP/1.1\r\nConnection: close\r\nAuthorization: Bearer " + g_token + "\r\n" + headers +
         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::string get(const std::string& route, const std::string& host = "127.0.0.1") {
  return "GET " + route + " HTTP/1.1\r\nConnection: close\r\nAuthorization: Bearer " + g_token + "\r\nHost: " + host +
         "\r\n\r\n";
}

DaemonSpec at_port(int port) {
  DaemonSpec where;
  where.http_port = port;
  return where;
}

constexpr const char* kJson = "Host: 127.0.0.1\r\nContent-Type: application/json\r\n";

class HttpApiTest : public ::testing::Test {
 protected:
  void SetUp() override {
    HttpHandlers handlers;
    handlers.status = [] { return std::string("{\"phase\":\"holding\"}"); };
    handlers.room_json = [] { return std::string("{}"); };
    handlers.room_png = [] { return std::string(); };
    handlers.scene = [](const HttpRequest& request) {
      const HttpHeaders headers = {{"ETag", "\"a\""}};
      return request.header("if-none-match") == "\"a\"" ? HttpResponse{304, "model/gltf-binary", "", headers}
                                                        : HttpResponse{200, "model/gltf-binary", "glTF", headers};
    };
    handlers.blackout = [this](bool on) -> Result<void> {
      blackouts += on ? 1 : 100;
      return {};
    };
    handlers.preview = [this](const PreviewQuestion& question, const std::string& client) -> Result<std::string> {
      previews +=
          fmt::format("{} {} {} ", question.changes.size(), question.reflections, client.substr(client.find('/')));
      if (question.changes[0].fixture == "nobody") return refusal("there is no nobody");
      if (question.client == "old") return tl::unexpected(Fault{Cause::cancelled, {}, "a newer one", {}});
      if (question.client == "late") return tl::unexpected(Fault{Cause::timeout, {}, "ask again", {}});
      return std::string("{}");
    };
    handlers.park = [this](const std::vector<std::string>& fixtures) -> Result<void> {
      if (!fixtures.empty() && fixtures[0] == "nobody") return refusal("there is no nobody");
      parked += static_cast<int>(fixtures.size()) + 1;
      return {};
    };
    handlers.level = [this](const std::vector<std::string>& names, double value,
                            const ByHandTimes& times) -> Result<std::string> {
      if (names[0] == "nobody") return refusal("there is no nobody");
      held += fmt::format("{}={}/{} ", fmt::join(names, "+"), value, times.for_s.value_or(-1));
      if (times.fade_s) held += fmt::format("in {} ", *times.fade_s);
      return std::string("held");
    };
    handlers.goal = handlers.level;
    handlers.levels = [this](const std::vector<std::pair<std::string, double>>& levels,
                             const ByHandTimes& times) -> Result<std::string> {
      for (const auto& [name, level] : levels) held += fmt::format("{}:{} ", name, level);
      held += fmt::format("/{} in {} ", times.for_s.value_or(-1), times.fade_s.value_or(-1));
      return std::string("held");
    };
    handlers.release = [this](const std::vector<std::string>& names,
                              std::optional<double> fade_s) -> Result<std::string> {
      held += fmt::format("-{} ", fmt::join(names, "+"));
      if (fade_s) held += fmt::format("in {} ", *fade_s);
      return std::string("1 released");
    };
    handlers.bypass = [this](const std::vector<std::string>& names, bool on) -> Result<std::string> {
      if (names[0] == "nobody") return refusal("there is no nobody");
      held += fmt::format("{}{} ", on ? "bypass " : "undo ", fmt::join(names, "+"));
      return std::string("watched by nobody");
    };
    handlers.question = [this](const HandQuestion& question, double seconds) {
      return questions.ask(question, from_seconds(seconds), Time{});
    };
    handlers.withdraw_question = [this](const std::string& id) { questions.withdraw(id); };
    handlers.answer = [this](const std::string& id, const HandAnswer& answer) {
      return questions.answer(id, answer, Time{});
    };
    handlers.reload = []() -> Checked<std::string> {
      return tl::unexpected(std::vector<Problem>{{"rig.toml", 7, 1, "[[bus]] \"dmx\" has changed", "restart"}});
    };
    handlers.plan = [this] { return applied > 0 ? std::string("{\"luxrig_plan\":1}") : std::string(); };
    handlers.apply = [this](const std::string& plan, std::optional<double> fade_s) -> Checked<std::string> {
      ++applied;
      if (fade_s) held += fmt::format("applied in {} ", *fade_s);
      if (const auto read = plan_from_json(plan, "plan"); plan.size() > 100 && !read)
        return tl::unexpected(read.error());
      if (plan == "{}") return std::string("spot held by hand");
      return tl::unexpected(std::vector<Problem>{{"plan", 1, 2, "is not a plan", "send one"}});
    };
    api = std::make_unique<HttpApi>(std::move(handlers), "/nonexistent");
    const auto bound = api->start(at_port(0));
    ASSERT_TRUE(bound) << bound.error().detail;
    port = *bound;
    std::ifstream in(token_file(*runtime_folder(), port));
    in >> g_token;
    ASSERT_EQ(g_token.size(), 64u);
  }
  std::unique_ptr<HttpApi> api;
  int port = 0;
  std::atomic<int> blackouts{0}, applied{0}, parked{0};
  std::string held, previews;
  QuestionBoard questions;
};

TEST_F(HttpApiTest, AnswersStatusAndBlackout) {
  EXPECT_NE(ask(port, get("/api/status")).find("holding"), std::string::npos);
  EXPECT_NE(ask(port, post("/api/blackout", "{\"on\":true}", kJson)).find(" 200 "), std::string::npos);
  EXPECT_EQ(blackouts, 1);
}

TEST_F(HttpApiTest, SaysThatTheSceneIsTheSameAndKeepsTheConnection) {
  const std::string head = "GET /api/scene HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer " + g_token + "\r\n";
  const std::string first = ask(port, head + "Connection: close\r\n\r\n");
  EXPECT_EQ(first.find("HTTP/1.1 200 OK\r\n"), 0u) << first;
  EXPECT_NE(first.find("Content-Length: 4\r\n"), std::string::npos) << first;
  const std::string again = ask(port, head + "If-None-Match: \"a\"\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(again.find("HTTP/1.1 304 Not Modified\r\n"), 0u) << again;
  EXPECT_EQ(again.find("Content-Length"), std::string::npos) << again;
  EXPECT_EQ(again.substr(again.size() - 4), "\r\n\r\n") << again;
  const std::string kept = ask(port, head + "If-None-Match: \"a\"\r\n\r\n", false);
  EXPECT_NE(kept.find("Connection: keep-alive"), std::string::npos) << kept;
}

TEST_F(HttpApiTest, RefusesOtherHostsOriginsAndContentTypes) {
  const std::string on = "{\"on\":false}";
  EXPECT_NE(ask(port, get("/api/status", "evil.example")).find(" 403 "), std::string::npos);
  EXPECT_NE(ask(port, post("/api/blackout", on, std::string(kJson) + "Origin: http://evil.example\r\n")).find(" 403 "),
            std::string::npos);
  EXPECT_NE(ask(port, post("/api/blackout", on, std::string(kJson) + "Origin: http://127.0.0.1.evil.example\r\n"))
                .find(" 403 "),
            std::string::npos);
  EXPECT_NE(ask(port, post("/api/blackout", on, "Host: 127.0.0.1\r\nContent-Type: text/plain\r\n")).find(" 415 "),
            std::string::npos);
  EXPECT_EQ(blackouts, 0);
}

TEST_F(HttpApiTest, RefusesBadBodiesWithAReason) {
  for (const char* body : {"", "{", "[]", "{\"on\":1}", "{\"on\":\"yes\"}", "null"}) {
    EXPECT_NE(ask(port, post("/api/blackout", body, kJson)).find(" 400 "), std::string::npos) << body;
  }
  EXPECT_EQ(blackouts, 0);
  const std::string answer = ask(port, post("/api/apply", "nonsense", kJson));
  EXPECT_NE(answer.find(" 400 "), std::string::npos);
  EXPECT_NE(answer.find("plan:1:2: is not a plan: send one"), std::string::npos) << answer;
}

TEST_F(HttpApiTest, ParksNamedHeadsOrAll) {
  EXPECT_NE(ask(port, post("/api/park", "{}", kJson)).find(" 200 "), std::string::npos);
  EXPECT_EQ(parked, 1);
  EXPECT_NE(ask(port, post("/api/park", R"({"fixtures":["a","b"]})", kJson)).find(" 200 "), std::string::npos);
  EXPECT_EQ(parked, 4);
  for (const char* body : {"", "[]", R"({"fixtures":"a"})", R"({"fixtures":[1]})", R"({"fixtures":{}})"})
    EXPECT_NE(ask(port, post("/api/park", body, kJson)).find(" 400 "), std::string::npos) << body;
  const std::string refused = ask(port, post("/api/park", R"({"fixtures":["nobody"]})", kJson));
  EXPECT_NE(refused.find(" 400 "), std::string::npos);
  EXPECT_NE(refused.find("there is no nobody"), std::string::npos) << refused;
  EXPECT_EQ(parked, 4);
}

TEST_F(HttpApiTest, SetsByHandAndReleases) {
  for (const auto& [route, body] : {
           std::pair{"/api/level", R"({"fixtures":["a","b*"],"level":0.05})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":1,"for_s":600})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":1,"fade_s":0.2})"},
           std::pair{"/api/goal", R"({"points":["p"],"goal_lux":150})"},
           std::pair{"/api/release", R"({"names":["p"]})"},
           std::pair{"/api/release", R"({"all":true})"},
           std::pair{"/api/level", R"({"levels":{"a":0.25,"b":1},"for_s":45,"fade_s":1})"},
           std::pair{"/api/release", R"({"all":true,"fade_s":10})"},
           std::pair{"/api/bypass", R"({"names":["m","s*"],"on":true})"},
           std::pair{"/api/bypass", R"({"names":["m"],"on":false})"},
       })
    EXPECT_NE(ask(port, post(route, body, kJson)).find(" 200 "), std::string::npos) << route << body;
  EXPECT_EQ(held, "a+b*=0.05/-1 a=1/600 a=1/-1 in 0.2 p=150/-1 -p - a:0.25 b:1 /45 in 1 - in 10 bypass m+s* undo m ");
  held.clear();
  for (const auto& [route, body] : {
           std::pair{"/api/level", R"({"fixtures":[],"level":0.05})"},
           std::pair{"/api/level", R"({"fixtures":"a","level":0.05})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":"full"})"},
           std::pair{"/api/level", R"({"fixtures":["a"]})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":0.1,"for_s":0})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":0.1,"for_s":1e300})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":0.1,"fade_s":0})"},
           std::pair{"/api/level", R"({"fixtures":["a"],"level":0.1,"fade_s":1e9})"},
           std::pair{"/api/level", R"({"fixtures":["nobody"],"level":0.1})"},
           std::pair{"/api/level", R"({"levels":{}})"},
           std::pair{"/api/level", R"({"levels":[0.1]})"},
           std::pair{"/api/level", R"({"levels":{"a":"full"}})"},
           std::pair{"/api/level", R"({"levels":{"a":0.1},"fade_s":0})"},
           std::pair{"/api/level", R"({"levels":{"a":0.1},"level":0.1,"fixtures":["a"]})"},
           std::pair{"/api/release", R"({"all":true,"fade_s":0})"},
           std::pair{"/api/goal", R"({"fixtures":["a"],"goal_lux":3})"},
           std::pair{"/api/release", "{}"},
           std::pair{"/api/release", R"({"all":false})"},
           std::pair{"/api/release", R"({"all":true,"names":["a"]})"},
           std::pair{"/api/release", "["},
           std::pair{"/api/bypass", R"({"names":[],"on":true})"},
           std::pair{"/api/bypass", R"({"names":["m"]})"},
           std::pair{"/api/bypass", R"({"names":["m"],"on":1})"},
           std::pair{"/api/bypass", R"({"names":["nobody"],"on":true})"},
           std::pair{"/api/bypass", "7"},
       })
    EXPECT_NE(ask(port, post(route, body, kJson)).find(" 400 "), std::string::npos) << route << body;
  EXPECT_EQ(held, "");
}

TEST_F(HttpApiTest, AQuestionIsAnsweredOnceByItsId) {
  const auto asked = [](const std::string& id, const std::string& more) {
    return R"({"id":")" + id +
           R"(","text":"hold it here","position":[1,2,0.8],"normal":[0,0,1],"step":1,"steps":2,"readings":0)" + more +
           "}";
  };
  const auto put = [&](const std::string& body) { return ask(port, post("/api/question", body, kJson)); };
  const auto answer = [&](const std::string& body) { return ask(port, post("/api/answer", body, kJson)); };
  const std::string reading = R"({"id":"a-1","what":"reading","lux":182.5})";
  EXPECT_NE(answer(reading).find(" 409 Conflict"), std::string::npos) << "nothing is asked";
  EXPECT_NE(put(asked("a-1", R"(,"for_s":45)")).find("{\"asked\":true}"), std::string::npos);
  ASSERT_TRUE(questions.present(Time{}));
  EXPECT_EQ(questions.present(Time{})->until, Time{} + std::chrono::seconds(45));
  for (const char* body :
       {"", "7", "[]", "{}", R"({"what":"skip"})", R"({"id":7,"what":"skip"})", R"({"id":"a 1","what":"skip"})",
        R"({"id":"a-1"})", R"({"id":"a-1","what":"reading"})", R"({"id":"a-1","what":"reading","lux":-1})",
        R"({"id":"a-1","what":"reading","lux":1e999})", R"({"id":"a-1","what":"reading","lux":200001})",
        R"({"id":"a-1","what":"reading","lux":"182"})"})
    EXPECT_NE(answer(body).find(" 400 "), std::string::npos) << body;
  EXPECT_FALSE(questions.present(Time{})->answer);
  EXPECT_NE(answer(R"({"id":"a-0","what":"skip"})").find(" 409 "), std::string::npos) << "another question";
  EXPECT_NE(answer(reading).find(" 200 "), std::string::npos);
  EXPECT_NE(answer(reading).find(" 200 "), std::string::npos) << "the same again";
  EXPECT_NE(answer(R"({"id":"a-1","what":"skip"})").find(" 409 "), std::string::npos) << "it has been answered";
  EXPECT_NE(put(asked("a-1", R"(,"for_s":45)")).find(R"("answer":{"lux":182.5,"what":"reading"})"), std::string::npos);
  EXPECT_NE(put(asked("a-2", R"(,"for_s":45,"fixture":"spot","level":0.5)")).find(" 200 "), std::string::npos);
  EXPECT_NE(answer(reading).find(" 409 "), std::string::npos) << "the question before";
  for (const std::string& body :
       {asked("a-3", ""), asked("a-3", R"(,"for_s":0)"), asked("a-3", R"(,"for_s":601)"),
        asked("a-3", R"(,"for_s":"45")"), asked("a 3", R"(,"for_s":45)"),
        asked("a-3", R"(,"for_s":45,"fixture":"spot")"), asked("a-3", R"(,"for_s":45,"known_to":-1)"),
        std::string(R"({"id":"a-2"})"), std::string(R"({"id":"a-2","withdrawn":false})")})
    EXPECT_NE(put(body).find(" 400 "), std::string::npos) << body;
  EXPECT_EQ(questions.present(Time{})->question.id, "a-2");
  EXPECT_NE(put(R"({"id":"a-1","withdrawn":true})").find(" 200 "), std::string::npos);
  EXPECT_TRUE(questions.present(Time{})) << "only its own";
  EXPECT_NE(put(R"({"id":"a-2","withdrawn":true})").find(" 200 "), std::string::npos);
  EXPECT_FALSE(questions.present(Time{}));
}

TEST_F(HttpApiTest, ARefusedReloadNamesItsKeyAndAnApplyItsHeldFixtures) {
  const std::string refused = ask(port, post("/api/reload", "{}", kJson));
  EXPECT_NE(refused.find(" 400 "), std::string::npos);
  EXPECT_NE(refused.find("rig.toml:7:1: [[bus]] \\\"dmx\\\" has changed: restart"), std::string::npos) << refused;
  const std::string applied_answer = ask(port, post("/api/apply", "{}", kJson));
  EXPECT_NE(applied_answer.find("\"applied\":true"), std::string::npos) << applied_answer;
  EXPECT_NE(applied_answer.find("spot held by hand"), std::string::npos) << applied_answer;
}

TEST_F(HttpApiTest, APreviewIsAskedForInOneOfThreeWays) {
  const auto ask_for = [&](const std::string& body) { return ask(port, post("/api/preview", body, kJson)); };
  for (
      const char* good :
      {R"({"fixtures":[{"fixture":"a","level":0.5}]})", R"({"fixtures":[{"fixture":"a","aim":[1,2,3]}],"client":"x"})",
       R"({"fixtures":[{"fixture":"a","pan_deg":1,"tilt_deg":2,"level":1},{"fixture":"b","level":0}],"reflections":true})"})
    EXPECT_NE(ask_for(good).find(" 200 "), std::string::npos) << good;
  EXPECT_EQ(previews, "1 false / 1 false /x 2 true / ");
  previews.clear();
  std::string many;
  for (int i = 0; i < 65; ++i) many += (i ? "," : "") + std::string(R"({"fixture":"a","level":0})");
  for (const std::string bad : {"",
                                "[]",
                                "{}",
                                R"({"fixtures":[]})",
                                R"({"fixtures":{"fixture":"a","level":1}})",
                                R"({"fixtures":[7]})",
                                R"({"fixtures":[{"fixture":"a"}]})",
                                R"({"fixtures":[{"level":1}]})",
                                R"({"fixtures":[{"fixture":7,"level":1}]})",
                                R"({"fixtures":[{"fixture":"a","level":1.01}]})",
                                R"({"fixtures":[{"fixture":"a","level":-0.01}]})",
                                R"({"fixtures":[{"fixture":"a","level":1e999}]})",
                                R"({"fixtures":[{"fixture":"a","level":null,"aim":[1,2,3]}]})",
                                R"({"fixtures":[{"fixture":"a","aim":[1,2]}]})",
                                R"({"fixtures":[{"fixture":"a","aim":[1,2,1e6]}]})",
                                R"({"fixtures":[{"fixture":"a","aim":[1,2,"3"]}]})",
                                R"({"fixtures":[{"fixture":"a","pan_deg":1}]})",
                                R"({"fixtures":[{"fixture":"a","aim":[1,2,3],"pan_deg":1,"tilt_deg":1}]})",
                                R"({"fixtures":[{"fixture":"a","level":1}],"reflections":1})",
                                R"({"fixtures":[{"fixture":"a","level":1}],"client":""})",
                                R"({"fixtures":[{"fixture":"a","level":1}],"client":"a b"})",
                                R"({"fixtures":[{"fixture":"a","level":1}],"client":1})"})
    EXPECT_NE(ask_for(bad).find(" 400 "), std::string::npos) << bad;
  EXPECT_NE(ask_for("{\"fixtures\":[" + many + "]}").find(" 400 "), std::string::npos);
  EXPECT_EQ(previews, "");
  EXPECT_NE(ask_for(R"({"fixtures":[{"fixture":"nobody","level":1}]})").find(" 400 "), std::string::npos);
  EXPECT_NE(ask_for(R"({"fixtures":[{"fixture":"a","level":1}],"client":"old"})").find(" 409 "), std::string::npos);
  EXPECT_NE(ask_for(R"({"fixtures":[{"fixture":"a","level":1}],"client":"late"})").find(" 503 "), std::string::npos);
}

TEST_F(HttpApiTest, APlanIsAppliedWithAFadeAndReadBack) {
  EXPECT_NE(ask(port, get("/api/plan")).find(" 404 "), std::string::npos);
  for (const std::string fade : {"", "0", "-1", "601", "nan", "inf", "1e999", "5s", "0x5", "%00"})
    EXPECT_NE(ask(port, post("/api/apply?fade_s=" + fade, "{}", kJson)).find(" 400 "), std::string::npos) << fade;
  EXPECT_EQ(applied, 0);
  EXPECT_NE(ask(port, post("/api/apply?fade_s=2.5", "{}", kJson)).find("\"applied\":true"), std::string::npos);
  EXPECT_EQ(held, "applied in 2.5 ");
  EXPECT_NE(ask(port, get("/api/plan")).find("\"luxrig_plan\":1"), std::string::npos);
}

TEST_F(HttpApiTest, StreamsEventsAndStopsWhileAClientListens) {
  const std::string first = ask(port, get("/api/events"), false);
  EXPECT_NE(first.find("200 OK"), std::string::npos);
  std::thread listener([&] { (void)ask(port, get("/api/events")); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  api->stop();
  listener.join();
}

TEST_F(HttpApiTest, ThePortRequiresTheTokenButTheSocketDoesNot) {
  const std::string right = g_token;
  for (const std::string& wrong : {std::string(), right + "0", std::string(64, '0')}) {
    g_token = wrong;
    for (const char* route : {"/api/status", "/api/events", "/api/room", "/api/room.png", "/api/universes"})
      EXPECT_NE(ask(port, get(route)).find(" 401 "), std::string::npos) << route;
    for (const char* route : {"/api/status", "/api/events"})
      EXPECT_EQ(ask(port, "HEAD" + get(route).substr(3)).find(" 200 "), std::string::npos) << route;
    for (const char* route :
         {"/api/blackout", "/api/apply", "/api/level", "/api/session", "/api/reload", "/api/question", "/api/answer"})
      EXPECT_NE(ask(port, post(route, "{\"on\":true}", kJson)).find(" 401 "), std::string::npos) << route;
  }
  EXPECT_EQ(blackouts, 0);
  EXPECT_NE(ask(port, get("/api/session")).find("\"open\":false"), std::string::npos);
  g_token = right;
  EXPECT_NE(ask(port, get("/api/session")).find("\"open\":true"), std::string::npos);
  const auto folder = runtime_folder();
  ASSERT_TRUE(folder);
  struct stat is {};
  for (const auto& file : {token_file(*folder, port), socket_file(*folder, port), *folder}) {
    ASSERT_EQ(::stat(file.c_str(), &is), 0) << file;
    EXPECT_EQ(is.st_mode & 077, 0u) << file;
  }
  const auto daemon = daemon_on(port);
  ASSERT_TRUE(daemon) << daemon.error().detail;
  EXPECT_FALSE(daemon->socket.empty());
  EXPECT_EQ(http_post_json(*daemon, "/api/blackout", "{\"on\":true}")->status, 200);
  EXPECT_EQ(blackouts, 1);
  api->stop();
  EXPECT_FALSE(std::filesystem::exists(token_file(*folder, port)));
  EXPECT_NE(daemon_on(port).error().detail.find("luxrig run"), std::string::npos);
}

TEST_F(HttpApiTest, AOneTimeAddressOpensOneBrowser) {
  const std::string right = std::exchange(g_token, "none");
  const std::string address = api->one_time_address();
  const std::string route = address.substr(address.find("/?"));
  const std::string first = ask(port, "GET " + route + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
  EXPECT_NE(first.find(" 303 "), std::string::npos) << first;
  EXPECT_NE(first.find("Location: /\r\n"), std::string::npos);
  const std::size_t at = first.find("Set-Cookie: ") + 12;
  const std::string cookie = first.substr(at, first.find(';', at) - at);
  const auto with_cookie = [&](const std::string& path, const std::string& more = "") {
    return ask(port, "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n" + more + "\r\n");
  };
  EXPECT_NE(with_cookie("/api/status", "Cookie: " + cookie + "\r\n").find("holding"), std::string::npos);
  EXPECT_NE(with_cookie("/api/status", "Cookie: " + cookie + "\r\nOrigin: http://127.0.0.1:81\r\n").find(" 403 "),
            std::string::npos)
      << "a browser sends it for pages of other ports, too";
  EXPECT_NE(with_cookie(route).find(" 403 "), std::string::npos) << "used";
  EXPECT_NE(with_cookie(route, "Cookie: " + cookie + "\r\n").find(" 303 "), std::string::npos) << "it is open already";
  EXPECT_NE(with_cookie("/").find(" 200 "), std::string::npos) << "the page itself is for everybody";
  g_token = right;
  EXPECT_NE(ask(port, post("/api/session", "{}", kJson)).find("/?open="), std::string::npos);
}

TEST_F(HttpApiTest, SixteenMegabytesOfBracketsAreRefusedWithoutKeepingMemory) {
  const auto kilobytes = [](const std::string& key) {
    std::ifstream in("/proc/self/status");
    for (std::string word; in >> word;)
      if (int kb = 0; word == key && in >> kb) return kb;
    return 0;
  };
  // Allocate the test's own data before measuring.
  const std::string body(16u << 20, '[');
  const std::string plan = post("/api/apply", body, kJson), level = post("/api/level", body, kJson);
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  const int before_kb = kilobytes("VmRSS:");
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(ask(port, plan).find(" 400 "), std::string::npos);
    EXPECT_NE(ask(port, level).find(" 413 "), std::string::npos);
  }
  if (!test::kSanitized) {
    EXPECT_LT(kilobytes("VmHWM:") - before_kb, 64 * 1024);
    EXPECT_LT(kilobytes("VmRSS:") - before_kb, 2 * 1024);
  }
  EXPECT_EQ(applied, 3);
}

TEST_F(HttpApiTest, SecondServerOnTheSamePortIsRefused) {
  HttpApi second({}, "/nonexistent");
  const auto bound = second.start(at_port(port));
  ASSERT_FALSE(bound);
  EXPECT_NE(bound.error().detail.find(std::to_string(port)), std::string::npos);
}

/// A daemon with accounts: anna operates, otto looks.
class AccountsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::path(::testing::TempDir()) / "luxrig_http_accounts";
    std::filesystem::create_directories(folder);
    DaemonSpec where = at_port(0);
    where.accounts_file = folder / "accounts.json";
    Accounts accounts;
    accounts.people = {{"anna", Role::operate, *password_hash("correct horse")},
                       {"otto", Role::look, *password_hash("battery staple")}};
    accounts.tokens = {{"ci", Role::look, token_hash("a token"), ""}};
    ASSERT_TRUE(write_accounts(where.accounts_file, accounts));
    HttpHandlers handlers;
    handlers.status = [] { return std::string("{}"); };
    handlers.blackout = [this](bool) -> Result<void> {
      ++blackouts;
      return {};
    };
    handlers.reload = []() -> Checked<std::string> { return std::string("reloaded"); };
    api = std::make_unique<HttpApi>(std::move(handlers), "/nonexistent");
    const auto bound = api->start(where);
    ASSERT_TRUE(bound) << bound.error().detail;
    port = *bound;
    EXPECT_EQ(api->problem(), "");
  }
  void TearDown() override {
    api.reset();
    std::filesystem::remove_all(folder);
  }
  [[nodiscard]] std::string say(const std::string& method, const std::string& route, const std::string& headers,
                                const std::string& body = "{}") const {
    return ask(port, method + " " + route + " HTTP/1.1\r\nConnection: close\r\n" + kJson + headers +
                         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  /// The cookie of a new session, as a header.
  [[nodiscard]] std::string logged_in(const std::string& name, const std::string& password) const {
    const std::string answer =
        say("POST", "/api/login", "", R"({"name":")" + name + R"(","password":")" + password + "\"}");
    const std::size_t at = answer.find("Set-Cookie: ");
    EXPECT_NE(at, std::string::npos) << answer;
    if (at == std::string::npos) return "";
    return "Cookie: " + answer.substr(at + 12, answer.find(';', at) - at - 12) + "\r\n";
  }

  std::filesystem::path folder;
  std::unique_ptr<HttpApi> api;
  int port = 0;
  std::atomic<int> blackouts{0};
};

TEST_F(AccountsTest, EachRoleMayWhatItsRoutesSayAndIsToldWhyNot) {
  const std::string anna = logged_in("anna", "correct horse"), otto = logged_in("otto", "battery staple");
  const std::string on = "{\"on\":true}";
  EXPECT_NE(say("GET", "/api/status", otto).find(" 200 "), std::string::npos);
  EXPECT_NE(say("GET", "/api/status", anna).find(" 200 "), std::string::npos);
  const std::string refused = say("POST", "/api/blackout", otto, on);
  EXPECT_NE(refused.find(" 403 "), std::string::npos) << refused;
  EXPECT_NE(refused.find("otto may look, and this is for those who may operate"), std::string::npos) << refused;
  EXPECT_EQ(blackouts, 0);
  EXPECT_NE(say("POST", "/api/blackout", anna, on).find(" 200 "), std::string::npos);
  EXPECT_EQ(blackouts, 1);
  EXPECT_NE(say("POST", "/api/reload", anna).find("anna may operate, and this is for those who may configure"),
            std::string::npos);
  const std::string script = "Authorization: Bearer a token\r\n";
  EXPECT_NE(say("GET", "/api/status", script).find(" 200 "), std::string::npos);
  EXPECT_NE(say("POST", "/api/blackout", script, on).find("script ci may look"), std::string::npos);
  EXPECT_NE(say("GET", "/api/session", otto).find(R"("name":"otto","open":true,"role":"look")"), std::string::npos);
  EXPECT_NE(say("POST", "/api/logout", otto).find("Max-Age=0"), std::string::npos);
  EXPECT_NE(say("GET", "/api/status", otto).find("log in on its page"), std::string::npos);
}

TEST_F(AccountsTest, AStolenCookieIsWorthNothingFromAnotherOrigin) {
  const std::string anna = logged_in("anna", "correct horse");
  for (const char* from : {"Origin: http://evil.example\r\n", "Sec-Fetch-Site: cross-site\r\n"})
    EXPECT_NE(say("POST", "/api/blackout", anna + from, "{\"on\":true}").find(" 403 "), std::string::npos) << from;
  EXPECT_EQ(blackouts, 0);
}

TEST_F(AccountsTest, WrongPasswordsAreToldToWait) {
  const std::string wrong = R"({"name":"anna","password":"wrong"})";
  for (int i = 0; i < 5; ++i) EXPECT_NE(say("POST", "/api/login", "", wrong).find(" 401 "), std::string::npos) << i;
  // The wait grows with each attempt, so a slow computer gets there, too.
  std::string answer;
  for (int i = 0; i < 20 && answer.find(" 429 ") == std::string::npos; ++i)
    answer = say("POST", "/api/login", "", wrong);
  EXPECT_NE(answer.find(" 429 "), std::string::npos) << answer;
  EXPECT_NE(answer.find("Retry-After: "), std::string::npos) << answer;
  EXPECT_NE(answer.find("too many attempts"), std::string::npos) << answer;
  for (const char* bad :
       {"[]", "{}", R"({"name":"anna"})", R"({"name":"a b","password":"x"})", R"({"name":1,"password":"x"})"})
    EXPECT_NE(say("POST", "/api/login", "", bad).find(" 400 "), std::string::npos) << bad;
}

TEST_F(AccountsTest, AChangeOfTheFileIsFollowedAndADamagedOneIsNobodys) {
  const std::string anna = logged_in("anna", "correct horse");
  const auto code = [&] { return std::atoi(say("GET", "/api/status", anna).c_str() + 9); };
  const auto becomes = [&](int wanted) {
    for (int i = 0; i < 3000 && code() != wanted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return code() == wanted;
  };
  EXPECT_EQ(code(), 200);
  ASSERT_EQ(::chmod((folder / "accounts.json").c_str(), 0644), 0);
  EXPECT_TRUE(becomes(401));
  EXPECT_NE(api->problem().find("chmod 600"), std::string::npos) << api->problem();
  ASSERT_EQ(::chmod((folder / "accounts.json").c_str(), 0600), 0);
  EXPECT_TRUE(becomes(200));
  EXPECT_EQ(api->problem(), "");
}

}  // namespace
}  // namespace luxrig
