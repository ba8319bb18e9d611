// Random calls: each is drawn once, and then made on several hosts.
#pragma once
#include <functional>
#include <string>

#include "choices.h"
#include "host.h"

namespace fuzz {

struct Call {
  std::string name;
  std::function<Outcome(Host&)> make;
  bool steps = false;      // it is a step
  bool composite = false;  // several calls: refused as a whole, it may have changed the world all the same
};

/// What a sequence is about: which calls come often, how many objects there are at most.
struct Theme {
  std::uint32_t most_bodies = 10, weights[8] = {};
  bool sleep = false;
  double size = 1;  // bodies are made within a box of so many metres
};
Theme draw_theme(Choices& choices);

/// The first calls: a floor, mostly, and settings.
std::vector<Call> first_calls(Choices& choices, const Theme& theme);
/// `host`: any of them, for how many objects there are.
Call draw_call(Choices& choices, const Theme& theme, const Host& host);

}  // namespace fuzz
