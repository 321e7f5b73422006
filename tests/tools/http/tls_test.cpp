// The server within TLS, asked by OpenSSL's own client, and by peers that speak something else.
#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "tests/tools/http/made_certificate.h"
#include "tools/http/client.h"
#include "tools/http/server.h"

namespace luxrig {
namespace {

using namespace std::chrono_literals;
using test::made_certificate;
using test::status_of;
using test::TlsWire;
using test::Wire;

constexpr std::chrono::seconds kHandshakeAnswered(60);

std::shared_ptr<const TlsIdentity> identity(const test::MadeCertificate& made) {
  auto out = TlsIdentity::make(made.certificate, made.key, "page.pem", "page-key.pem");
  EXPECT_TRUE(out) << (out ? "" : out.error().front().text());
  return out ? *out : nullptr;
}

class TlsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    HttpServerOptions options;
    options.routes = {{"GET", "/who",
                       [](const HttpRequest& request) {
                         return HttpResponse{200, "text/plain", (request.secure ? "secure " : "plain ") + request.from};
                       }},
                      {"POST", "/changed",
                       [](const HttpRequest& request) {
                         return HttpResponse{200, "text/plain", std::to_string(request.body.size())};
                       },
                       1u << 20},
                      {"GET", "/events",
                       [](const HttpRequest&) {
                         return HttpResponse{200, "text/event-stream", "data: 1\n\n"};
                       },
                       0, false, 1, true}};
    server = std::make_unique<HttpServer>(std::move(options));
    port = server->bind(0).value_or(0);
    server->use(identity(made_certificate("DNS:Rig.example,DNS:*.museum.example,IP:192.168.1.5")));
    server->start();
  }
  std::unique_ptr<HttpServer> server;
  int port = 0;
};

std::string get(const std::string& host, const std::string& headers = "", const char* path = "/who") {
  return std::string("GET ") + path + " HTTP/1.1\r\nConnection: close\r\nHost: " + host + "\r\n" + headers + "\r\n";
}

TEST_F(TlsTest, AnswersARealClientAndEndsInOrder) {
  TlsWire wire(port);
  ASSERT_TRUE(wire.connected());
  EXPECT_EQ(wire.version(), "TLSv1.3");
  const std::string answer = wire.ask(get("rig.example"));
  EXPECT_EQ(status_of(answer), 200) << answer;
  EXPECT_NE(answer.find("secure 127.0.0.1"), std::string::npos) << answer;
  EXPECT_TRUE(wire.ended_in_order) << "a client could not tell a whole answer from one that was cut";
  const std::string body(1u << 20, 'x');
  TlsWire large(port);
  const std::string taken = large.ask(
      "POST /changed HTTP/1.1\r\nConnection: close\r\nHost: rig.example\r\nContent-Type: application/json\r\n"
      "Content-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body);
  EXPECT_NE(taken.find("\r\n\r\n1048576"), std::string::npos) << taken;
}

TEST_F(TlsTest, RefusesVersionsThatAreOld) {
  EXPECT_EQ(TlsWire(port, TLS1_2_VERSION).version(), "TLSv1.2");
  EXPECT_TRUE(TlsWire(port, TLS1_2_VERSION).connected());
  EXPECT_FALSE(TlsWire(port, TLS1_1_VERSION).connected());
  EXPECT_FALSE(TlsWire(port, TLS1_VERSION).connected());
}

TEST_F(TlsTest, KnowsTheNamesOfItsCertificateAndNoOthers) {
  const std::string with_port = ":" + std::to_string(port);
  for (const std::string& ours :
       {std::string("rig.example"), "RIG.example" + with_port, std::string("east.museum.example"),
        std::string("192.168.1.5"), "127.0.0.1" + with_port, std::string("[::1]")})
    EXPECT_EQ(status_of(TlsWire(port).ask(get(ours))), 200) << ours;
  for (const char* others :
       {"evil.example", "museum.example", ".museum.example", "a.b.museum.example", "rig.example.evil.example",
        "192.168.1.6", "rig.example:", "rig.example:x", "", "[::1", "*.museum.example:"})
    EXPECT_EQ(status_of(TlsWire(port).ask(get(others))), 403) << others;
  EXPECT_EQ(status_of(TlsWire(port).ask(get("rig.example", "Origin: https://rig.example\r\n"))), 200);
  EXPECT_EQ(status_of(TlsWire(port).ask(get("rig.example", "Origin: http://rig.example\r\n"))), 403) << "not by http";
}

TEST_F(TlsTest, TellsAPeerThatSpeaksPlainHttpToUseHttps) {
  Wire wire(port);
  ASSERT_TRUE(wire.send(get("rig.example")));
  const std::string answer = wire.receive(kHandshakeAnswered);
  EXPECT_EQ(status_of(answer), 400) << answer;
  EXPECT_NE(answer.find("begin the address with https://"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("127.0.0.1"), std::string::npos) << "it was handled";
}

TEST_F(TlsTest, GarbageAndSilenceEndTheirConnectionAlone) {
  Wire silent(port), half(port);
  ASSERT_TRUE(half.send(std::string("\x16\x03\x01\x02", 4)));  // a record that does not go on
  for (const std::string& garbage :
       {std::string(300, '\0'), std::string("\x80\x2e\x01", 3), std::string("SSH-2.0-x\r\n"),
        std::string("\x16\x03\x01\x00\x04\xff\xff\xff\xff", 9)}) {
    Wire wire(port);
    ASSERT_TRUE(wire.send(garbage));
    const std::string answer = wire.receive(kHandshakeAnswered);
    EXPECT_TRUE(wire.ended());
    EXPECT_EQ(answer.find("127.0.0.1"), std::string::npos);
  }
  EXPECT_EQ(status_of(TlsWire(port).ask(get("rig.example"))), 200) << "others are served meanwhile";
  // The deadline of a handshake.
  (void)silent.receive(kHandshakeAnswered);
  EXPECT_TRUE(silent.ended());
  (void)half.receive(kHandshakeAnswered);
  EXPECT_TRUE(half.ended());
}

TEST_F(TlsTest, AFloodOfHandshakesThatDoNotGoOnShutsNobodyOut) {
  std::vector<Wire> flood;
  for (int i = 0; i < 100; ++i) flood.emplace_back(port);
  EXPECT_EQ(status_of(TlsWire(port).ask(get("rig.example"))), 200);
}

TEST_F(TlsTest, NewConnectionsHaveTheNewCertificate) {
  const std::string before = TlsWire(port).fingerprint();
  EXPECT_EQ(TlsWire(port).fingerprint(), before);
  server->use(identity(made_certificate("DNS:new.example")));
  EXPECT_NE(TlsWire(port).fingerprint(), before);
  EXPECT_EQ(status_of(TlsWire(port).ask(get("new.example"))), 200);
  EXPECT_EQ(status_of(TlsWire(port).ask(get("rig.example"))), 403);
}

TEST(TlsIdentity, WhatDoesNotBelongTogetherIsRefusedInWords) {
  const auto made = made_certificate("DNS:rig.example"), other = made_certificate("DNS:rig.example");
  const auto why = [](const std::string& certificate, const std::string& key) {
    const auto read = TlsIdentity::make(certificate, key, "page.pem", "page-key.pem");
    return read ? "" : read.error().front().text();
  };
  EXPECT_EQ(why(made.certificate, made.key), "");
  EXPECT_NE(why("", made.key).find("page.pem:0:0: is no certificate"), std::string::npos);
  EXPECT_NE(why("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n", made.key).find("is no certificate"),
            std::string::npos);
  EXPECT_NE(why(made.certificate, other.key).find("page-key.pem:0:0: is no key"), std::string::npos);
  EXPECT_NE(why(made.certificate, "").find("is no key"), std::string::npos);
  const auto nameless = made_certificate("");
  EXPECT_NE(why(nameless.certificate, nameless.key).find("names no host"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
