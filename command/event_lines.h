// Events of a run as lines of JSON, one an event.
#pragma once
#include <cstdint>
#include <string>

#include "output.h"
#include "pcphys/events.h"

namespace pcphys::command {

class EventLines {
 public:
  void add(std::uint64_t step, const StepEvents& events);
  const std::string& text() const { return text_; }

 private:
  void line(std::uint64_t step, const char* event, Json rest);
  std::string text_;
};

}  // namespace pcphys::command
