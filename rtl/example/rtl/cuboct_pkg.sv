// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// The constants of the plan; docs/reference/node.md says what each is.
package cuboct_pkg;
  localparam int          Axes                 = 3;             // 3, or 2 where nothing happens along z
  localparam int          Capacity             = 8;             // particles per node
  localparam int          FilterLanes          = 4;             // own particles that a candidate meets per cycle
  localparam int          ForcePipes           = 1;             // pairs per cycle
  localparam int          Shared               = 0;             // 1: one multiplier serves the axes in turn
  localparam int          Product              = 1;             // cycles of a multiplier
  localparam int          Interval             = 1;             // cycles from one pair to the next
  localparam int          QueueDepth           = 4;             // entries between filter and pipes
  localparam int          Overlap              = 1;             // 1: the force engine starts with the exchange
  localparam int          Arrival              = 0;             // 1: halos are used as they come
  localparam int          Streamers            = 1;             // candidates per cycle
  localparam int          Narrow               = 0;             // 1: memories of words of LinkBits, one port to read
  localparam int          LinkBits             = 64;            // payload of a beat
  localparam int          IdBits               = 3;
  localparam int          TypeBits             = 0;             // 0 with one type
  localparam int          PositionFrac         = 20;            // fractional bits of x that forces and links see
  localparam int          Guard                = 8;             // v and the owner's x have PositionFrac + Guard fractional bits
  localparam int          VelocityBits         = 29;
  localparam int          RelativeVelocityBits = 18;
  localparam int          StrengthBits         = 21;            // s, and the entries of the tables
  localparam int          SumBits              = 29;            // a particle's summed kick
  localparam int          DisplacementBits     = 29;
  localparam int          ScaleFrac            = 16;            // fractional bits of the pair scales
  localparam int          GainFrac             = 16;            // fractional bits of kp, kd
  localparam int          GainBits             = 18;
  localparam int          ScaleBits            = 18;
  localparam int          ConstantBits         = 29;            // imposed velocities and gravity
  localparam int          FilterFrac           = 10;            // leading bits of a position that the filter tests
  localparam int          DifferenceShift      = 4;
  localparam int          WShift               = 8;
  localparam int          QShift               = 17;
  localparam int          DampShift            = 0;
  localparam int          KickShift            = 11;
  localparam logic [63:0] Cutoff2              = 64'h100000000;  // in units of r2
  localparam logic [63:0] Contact2             = 64'h0;         // as Cutoff2, of types that only touch; 0: no two do
  localparam logic [63:0] PlanarOne            = 64'h400;       // FilterFrac fractional bits
  localparam logic [63:0] PlanarTwo            = 64'h5aa;
  localparam logic [63:0] PlanarThree          = 64'h6f0;
  localparam int          Octaves              = 0;             // force table: 0 uniform, 1 by octaves
  localparam int          Degree               = 1;
  localparam int          IndexBits            = 4;
  localparam int          BinBits              = 0;
  localparam int          FirstOctave          = 0;
  localparam int          FractionBits         = 17;
  localparam int          ForceBits            = 21;            // that hold every value of the force table
  localparam int          Damped               = 0;
  localparam int          Scaled               = 0;             // pairs of types differ
  localparam int          Weighted             = 0;             // masses of types differ
  localparam int          LawBits              = 0;             // of the law of a pair of types; 0: all have one
  localparam int          Pd                   = 0;             // some type is held by force
  localparam int          ParticleBits         = 178;           // of the words to load and observe
endpackage
