// The clock that engines are compared by.
#pragma once

namespace pcphys::cases {

/// Of this thread's own work [s]: what else runs on the machine does not count.
double thread_clock();
/// What reading the clock twice takes by itself [s]; steps can be that short.
double clock_cost();

}  // namespace pcphys::cases
