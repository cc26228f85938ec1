"""Files of a laboratory in, datasets of the contract 'test' out."""
