// Whether all designs compute the same bits.
#pragma once

namespace pcphys::architectures {

/// Runs every scene small in every design and history and prints what differs. True: nothing does, and free flight is
/// that of the library's own stepper.
bool check();

}  // namespace pcphys::architectures
