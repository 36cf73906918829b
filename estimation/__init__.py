"""The belief: a joint Gaussian over base and objects, and what is known of each object's type, colour and weight."""
