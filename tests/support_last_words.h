// What a process says before it ends by abort(): such an end is seen from outside, in a child of the test's own.
#pragma once
#include <functional>
#include <string>

namespace worldtest {

/// What a process that does this says on standard error before abort() ends it; "" if it does not end so.
std::string last_words(const std::function<void()>& does);
/// Whether the sentence is among them.
bool says(const std::function<void()>& does, const char* sentence);

}  // namespace worldtest
