"""The contract between worlds and learners: a semi-Markov decision process over objects.

In every state, a world offers a finite set of ground actions: action types with objects of the state bound
to their parameters. An action may be an option that lasts longer than one unit of time (Palmer (2015),
section 2.1). `World` and the conventions below are all that a learner needs from a world; a world knows
nothing about learners.

Conventions of the Gymnasium face of a world
--------------------------------------------
- The action space is a flat ``Discrete`` space; `Decision.indices` lists the available members, and
  ``info["action_mask"]`` (int8 over the whole space) marks the same ones. A world may offer them as a method
  too: ``action_masks()``, bool.
- ``info["scene"]`` is a `relforest.Scenes` of length 1: the objects of the state, no arguments bound and no
  private ones (see `Decision`).
- After a step, ``info["duration"]`` is the time that the action took, in the world's units, finite and not
  negative. It is 0 if another agent must choose at the same moment, before any time passes.
- After a reset, ``info["duration_before"]`` and ``info["reward_before"]`` may be the time and the reward
  before the first decision, 0 if they are missing. They belong to the score of the episode, and to no action.
- The reward of ``env.step`` is the undiscounted total over the action; ``info["discounted_reward"]`` is
  the total discounted to the beginning of the action, and may be omitted if it equals the reward.
- ``terminated`` marks a terminal state (nothing follows, its value is 0); ``truncated`` marks a time limit.
- `Decision.remaining`, where the task limits the number of actions, falls by one with every action; it is 0
  in a terminal state, and 0 only at the end of an episode. A task without such a limit leaves it out.

`relforest.testing.check_world` checks whether a world follows them.

A world may also offer to play many episodes together, which is faster (`LockstepWorld`), and to propose more
actions while somebody chooses (`RefiningWorld`).
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
