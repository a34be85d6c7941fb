"""Ships in a picture: painted hulls, and models on their decks."""
